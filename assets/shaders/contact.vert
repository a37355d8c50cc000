// A contact: a ring in the tangent plane (corners 0 to 5) and a needle along the normal (6 to 11).
layout(location = 0) in vec4 point_penetration;
layout(location = 1) in vec4 normal_impulse;
layout(location = 2) in float size;  // m, radius of the smaller body

uniform float strength;  // opacity of this pass

flat out vec4 color;
flat out float half_width;
flat out float ring_px;            // radius of the ring in drawn pixels; 0: a needle
noperspective out float across;
out vec2 in_ring;                  // -1 to 1

void main() {
  vec3 point = point_penetration.xyz, normal = normal_impulse.xyz;
  vec3 in_view = (view * vec4(point, 1.0)).xyz;
  float metre_px = 0.5 * pixels.y / (lens.y * (lens.z > 0.5 ? max(-in_view.z, lens.w) : 1.0));
  float radius = max(0.38 * size, 3.0 * values.w / metre_px);
  int corner = gl_VertexID % 6;
  across = 0.0;
  in_ring = vec2(0.0);
  half_width = 0.8 * values.w;
  if (gl_VertexID < 6) {
    const int order[6] = int[6](0, 1, 2, 2, 1, 3);
    int i = order[corner];
    ring_px = radius * metre_px;
    float reach = radius * (1.0 + 1.5 * values.w / ring_px);
    vec3 side = normalize(cross(normal, abs(normal.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
    vec3 other = cross(normal, side);
    in_ring = (vec2(i & 1, i >> 1) * 2.0 - 1.0) * reach / radius;
    color = vec4(1.0, 0.27, 0.24, strength);
    gl_Position = projection * (view * vec4(point + radius * (in_ring.x * side + in_ring.y * other), 1.0));
  } else {
    ring_px = 0.0;
    color = vec4(1.0, 0.94, 0.90, strength);
    float reach = max(0.7 * size, 6.0 * values.w / metre_px);
    gl_Position = line_corner(point - reach * normal, point + reach * normal, half_width, corner, across);
  }
  gl_Position.z *= 1.0004;
}
