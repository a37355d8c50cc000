// Where the reference has a body: a quad before each sphere, with a pixel of room for the soft edge of its outline.
struct Ghost {
  vec4 body_radius, offset_opacity;
};
layout(std430, binding = 0) readonly buffer Ghosts { Ghost ghosts[]; };

uniform int first;       // record to begin with
uniform float strength;  // opacity of this pass

flat out vec3 center;  // in view space
flat out float radius;
flat out float opacity;

void main() {
  Ghost ghost = ghosts[first + gl_VertexID / 6];
  center = (view * vec4(ghost.body_radius.xyz + ghost.offset_opacity.xyz, 1.0)).xyz;
  radius = ghost.body_radius.w;
  // One that lies where its body does has little to say.
  float apart = length(ghost.offset_opacity.xyz) / radius;
  opacity = strength * ghost.offset_opacity.w * mix(0.3, 1.0, smoothstep(0.0, 0.1, apart));

  const int order[6] = int[6](0, 1, 2, 2, 1, 3);
  int i = order[gl_VertexID % 6];
  vec2 corner = vec2(i & 1, i >> 1) * 2.0 - 1.0;
  bool perspective = lens.z > 0.5;
  float distance = length(center);
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // nothing: behind the eye, or around it
  if (opacity <= 0.0 || perspective && (center.z > radius || distance < 1.01 * radius)) return;
  float pixel = 2.0 * lens.y * pixels.w * (perspective ? max(-center.z, lens.w) : 1.0);
  float grown = radius + 1.5 * pixel;
  vec3 away = perspective ? center / distance : vec3(0.0, 0.0, -1.0);
  vec3 side = normalize(cross(away, abs(away.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  vec3 up = cross(side, away);
  float reach = grown;
  if (perspective && distance > grown) reach = grown * distance * inversesqrt(distance * distance - grown * grown);
  gl_Position = projection * vec4(center + reach * (corner.x * side + corner.y * up), 1.0);
}
