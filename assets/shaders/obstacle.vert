// A box among the obstacles: six faces of two triangles each, made from the vertex number.
struct Obstacle {
  vec4 center, half_size;
  vec4 side[3];  // unit, its axes in the world's
};
layout(std430, binding = 0) readonly buffer Obstacles { Obstacle obstacles[]; };

out vec2 place;  // on the face, m
flat out vec3 outward;

void main() {
  Obstacle box = obstacles[gl_InstanceID];
  int face = gl_VertexID / 6, axis = face >> 1, u = (axis + 1) % 3, v = (axis + 2) % 3;
  float way = (face & 1) == 0 ? 1.0 : -1.0;
  const vec2 corners[6] = vec2[6](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1));
  vec2 corner = corners[gl_VertexID % 6];
  place = corner * vec2(box.half_size[u], box.half_size[v]);
  outward = way * box.side[axis].xyz;
  vec3 point = box.center.xyz + box.half_size[axis] * outward + place.x * box.side[u].xyz + place.y * box.side[v].xyz;
  gl_Position = projection * (view * vec4(point, 1.0));
}
