// The mean over the 4 x 4 turns of the sample spiral, of those neighbours that lie at about the same depth.
layout(binding = 0) uniform sampler2D visibility;
layout(binding = 1) uniform sampler2D depths;

vec4 shade(vec2 pixel) {
  ivec2 at = ivec2(pixel);
  int step_px = int(values.w);
  ivec2 last = textureSize(visibility, 0) - 1;
  float depth = texelFetch(depths, at * step_px, 0).r;
  float sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      ivec2 other = clamp(at + ivec2(x, y), ivec2(0), last);
      float near_by = max(0.0, 1.0 - abs(texelFetch(depths, other * step_px, 0).r / max(depth, 1e-12) - 1.0) * 40.0) + 1e-4;
      sum += near_by * texelFetch(visibility, other, 0).r;
      weight += near_by;
    }
  return vec4(sum / weight);
}
