flat in vec4 color;
flat in float half_width;
flat in float ring_px;
noperspective in float across;
in vec2 in_ring;

layout(location = 0) out vec4 out_color;

void main() {
  float covered;
  if (ring_px > 0.0) {
    float from_center = length(in_ring);
    float softness = max(fwidth(from_center), 1e-5);
    float disc = clamp((1.0 - from_center) / softness + 0.5, 0.0, 1.0);
    float rim = clamp((from_center - 1.0 + 2.0 * half_width / ring_px) / softness + 0.5, 0.0, 1.0);
    covered = disc * mix(0.45 * color.a, 1.0, rim);
  } else {
    covered = line_coverage(across, half_width);
  }
  if (covered <= 0.0) discard;
  out_color = vec4(color.rgb, color.a * covered);
}
