// A plane: a square about the middle of the scene, faded to a disc. Compiled twice: surfaces (default), the side on
// which bodies are, and VEIL, what is seen through: planes from behind, and the reference grid from both sides.
struct Plane {
  vec4 normal_offset;  // bodies stay where normal . x >= offset
  vec4 center_radius;  // radius at which it has faded
  vec4 side_kind;      // a direction of its lines; 0: an obstacle, 1: the floor of the box, 2: a reference grid
};
layout(std430, binding = 0) readonly buffer Planes { Plane planes[]; };

out vec3 point;
out vec2 place;  // on the plane, m
flat out vec2 middle;
flat out int number;

void main() {
  Plane plane = planes[gl_InstanceID];
  vec3 normal = plane.normal_offset.xyz, side = plane.side_kind.xyz, other = cross(normal, side);
  vec3 center = plane.center_radius.xyz;
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  middle = vec2(dot(center, side), dot(center, other));
  place = middle + corner * plane.center_radius.w;
  point = center + plane.center_radius.w * (corner.x * side + corner.y * other);
  number = gl_InstanceID;
  gl_Position = projection * (view * vec4(point, 1.0));

  bool in_front = lens.z > 0.5 ? dot(inverse_view[3].xyz - center, normal) > 0.0 : dot(inverse_view[2].xyz, normal) > 0.0;
  int kind = int(plane.side_kind.w);
#if defined(VEIL)
  bool drawn = kind == 2 || (kind == 0 && !in_front);
#else
  bool drawn = kind != 2 && in_front;  // from below, the floor would hide everything
#endif
  if (!drawn) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
