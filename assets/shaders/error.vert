// From a body towards its ghost, so many times as far: a shaft and two barbs (6 vertices each).
struct Ghost {
  vec4 body_radius, offset_opacity;
};
layout(std430, binding = 0) readonly buffer Ghosts { Ghost ghosts[]; };

uniform int first;            // record to begin with
uniform float strength;       // opacity of this pass
uniform float magnification;  // of the error
uniform vec4 tint;

flat out vec4 color;
flat out float half_width;
noperspective out float across;

void main() {
  Ghost ghost = ghosts[first + gl_VertexID / 18];
  int line = gl_VertexID % 18 / 6, corner = gl_VertexID % 6;
  vec3 from = ghost.body_radius.xyz, reach = magnification * ghost.offset_opacity.xyz, to = from + reach;
  vec3 in_view = (view * vec4(from, 1.0)).xyz;
  float metre_px = 0.5 * pixels.y / (lens.y * (lens.z > 0.5 ? max(-in_view.z, lens.w) : 1.0));
  vec3 eye_side = lens.z > 0.5 ? normalize(inverse_view[3].xyz - from) : inverse_view[2].xyz;
  float long_px = length(reach - dot(reach, eye_side) * eye_side) * metre_px / values.w;  // as it is seen
  half_width = 0.9 * values.w;
  across = 0.0;
  // What is shorter than a pixel is no direction.
  color = vec4(tint.rgb, strength * ghost.offset_opacity.w * smoothstep(0.5, 2.0, long_px));
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // nothing
  if (color.a <= 0.0) return;
  if (line > 0) {
    vec3 along = normalize(reach), aside = cross(along, eye_side);
    aside *= inversesqrt(max(dot(aside, aside), 1e-12)) * (line == 1 ? 1.0 : -1.0);
    float barb = min(0.35 * long_px, 7.0) * values.w / metre_px;
    from = to;
    to -= barb * (0.87 * along + 0.5 * aside);
  }
  gl_Position = line_corner(from, to, half_width, corner, across);
  gl_Position.z *= 1.0004;
}
