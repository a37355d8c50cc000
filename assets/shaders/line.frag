flat in vec4 color;
flat in float half_width;
noperspective in float across;

layout(location = 0) out vec4 out_color;

void main() {
  float covered = line_coverage(across, half_width);
  if (covered <= 0.0) discard;
  out_color = vec4(color.rgb, color.a * covered);
}
