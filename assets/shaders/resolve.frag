// The mean of the drawn pixels of each picture pixel, more than one.
layout(binding = 0) uniform sampler2D drawn;

layout(location = 0) out vec4 out_color;

void main() {
  int n = int(values.w);
  ivec2 at = ivec2(gl_FragCoord.xy) * n;
  vec3 sum = vec3(0.0);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) sum += texelFetch(drawn, at + ivec2(x, y), 0).rgb;
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy + 11.0, vec2(0.06711056, 0.00583715)))) - 0.5;
  out_color = vec4(sum / float(n * n) + noise * 0.5 / 255.0, 1.0);
}
