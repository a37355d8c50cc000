// A joint: up to 20 lines (6 vertices each), then rings where it holds. A rope sags, a spring is a zigzag in the plane
// of the picture, a ball or hinge goes from centre to centre by way of the point that they share, a hinge shows its axis.
struct Joint {
  vec4 from_look, to_size, at, aside;
};
layout(std430, binding = 0) readonly buffer Joints { Joint joints[]; };

uniform int first;       // record to begin with
uniform float strength;  // opacity of this pass

flat out vec4 color;
flat out float half_width;
flat out float ring_px;            // radius of the ring in drawn pixels; 0: a line
noperspective out float across;
out vec2 in_ring;                  // -1 to 1

const int rope = 1, spring = 2, corner = 3;
const vec3 tints[4] = vec3[4](vec3(0.93, 0.80, 0.52), vec3(0.93, 0.80, 0.52), vec3(0.52, 0.86, 0.72), vec3(0.98, 0.62, 0.45));

float metres_to_pixels(vec3 point) {
  vec3 in_view = (view * vec4(point, 1.0)).xyz;
  return 0.5 * pixels.y / (lens.y * (lens.z > 0.5 ? max(-in_view.z, lens.w) : 1.0));
}

// A point of the line, 0 to `lines` on the way.
vec3 point_of(Joint joint, int look, int step, int lines) {
  vec3 from = joint.from_look.xyz, to = joint.to_size.xyz;
  float t = float(step) / float(lines);
  vec3 point = mix(from, to, t);
  if (look == rope) point += 4.0 * t * (1.0 - t) * joint.aside.xyz;
  if (look == spring && step > 2 && step < lines - 2) {
    vec3 eye = (inverse_view * vec4(0.0, 0.0, lens.z > 0.5 ? 0.0 : 1.0, lens.z > 0.5 ? 1.0 : 0.0)).xyz;
    vec3 side = cross(to - from, lens.z > 0.5 ? eye - point : eye);
    float size = dot(side, side);
    if (size > 0.0) point += ((step & 1) == 0 ? 0.28 : -0.28) * joint.to_size.w * side * inversesqrt(size);
  }
  return point;
}

void main() {
  Joint joint = joints[first + gl_VertexID / 132];
  int vertex = gl_VertexID % 132, look = int(joint.from_look.w);
  float size = joint.to_size.w;
  color = vec4(tints[look], strength);
  across = 0.0;
  in_ring = vec2(0.0);
  ring_px = 0.0;
  vec3 middle = look == corner ? joint.at.xyz : 0.5 * (joint.from_look.xyz + joint.to_size.xyz);
  half_width = clamp(0.07 * size * metres_to_pixels(middle), 0.6 * values.w, 4.0 * values.w);
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // nothing
  if (vertex < 120) {
    int line = vertex / 6, at_corner = vertex % 6;
    if (look == corner) {
      vec3 at = joint.at.xyz, axis = joint.aside.xyz;
      if (line == 2 && dot(axis, axis) == 0.0 || line > 2) return;
      vec3 from = line == 0 ? joint.from_look.xyz : line == 1 ? at : at - axis;
      vec3 to = line == 0 ? at : line == 1 ? joint.to_size.xyz : at + axis;
      gl_Position = line_corner(from, to, half_width, at_corner, across);
    } else {
      int lines = look == 0 ? 1 : 20;
      if (line >= lines) return;
      gl_Position = line_corner(point_of(joint, look, line, lines), point_of(joint, look, line + 1, lines), half_width,
                                at_corner, across);
    }
  } else {
    int ring = (vertex - 120) / 6;
    if (look == corner && ring == 1) return;
    vec3 point = look == corner ? joint.at.xyz : ring == 0 ? joint.from_look.xyz : joint.to_size.xyz;
    float metre_px = metres_to_pixels(point), radius = max(0.16 * size, 2.2 * values.w / metre_px);
    const int order[6] = int[6](0, 1, 2, 2, 1, 3);
    int i = order[vertex % 6];
    ring_px = radius * metre_px;
    float reach = radius * (1.0 + 1.5 * values.w / ring_px);
    in_ring = (vec2(i & 1, i >> 1) * 2.0 - 1.0) * reach / radius;
    vec4 in_view = view * vec4(point, 1.0);
    in_view.xy += radius * in_ring;
    gl_Position = projection * in_view;
  }
  gl_Position.z *= 1.0004;
}
