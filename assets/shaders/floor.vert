// The floor: a square about the scene, faded to a disc.
out vec2 place;

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  place = ground.xy + corner * ground.w;
  gl_Position = projection * (view * vec4(place, ground.z, 1.0));
}
