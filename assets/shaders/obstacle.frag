// A surface of the kind of planes (plane.frag): gridded, lit and shadowed, and not faded.
in vec2 place;
flat in vec3 outward;
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_normal;

float grid_lines(vec2 at, float spacing, float half_width) {
  vec2 cell = at / spacing;
  vec2 wide = max(fwidth(cell), 1e-6);
  vec2 from_line = abs(fract(cell + 0.5) - 0.5) / wide;  // drawn pixels
  vec2 covered = clamp(half_width + 0.5 - from_line, 0.0, 1.0) * min(vec2(1.0), 0.25 / wide);  // fades where too dense
  return max(covered.x, covered.y);
}

void main() {
  float line = max(0.55 * grid_lines(place, scale.y, 0.6 * values.w), 0.2 * grid_lines(place, scale.y * 0.2, 0.4 * values.w));
  out_albedo = vec4(vec3(0.15 + line), 0.75);  // colour is made in the lighting pass
  out_normal = vec4(outward * 0.5 + 0.5, 1.0);
}
