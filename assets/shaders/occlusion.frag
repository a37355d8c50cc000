// Ambient obscurance from depth and normal (McGuire, Mara and Luebke 2012, without the depth pyramid), one value
// for each picture pixel. The turn of the sample spiral repeats every 4 x 4 pixels; the blur below has that size.
layout(binding = 0) uniform sampler2D depths;
layout(binding = 1) uniform sampler2D normals;

const int samples = 14;

vec4 shade(vec2 pixel) {
  int step_px = int(values.w);
  ivec2 at = ivec2(pixel) * step_px;
  float depth = texelFetch(depths, at, 0).r;
  if (depth <= 0.0) return vec4(1.0);
  vec3 point = view_point(vec2(at) + 0.5, depth);
  vec3 normal = mat3(view) * (texelFetch(normals, at, 0).xyz * 2.0 - 1.0);
  float reach = scale.x;
  float distance = lens.z > 0.5 ? -point.z : 1.0;
  float reach_px = min(reach / (distance * lens.y) * 0.5 * pixels.y, 0.15 * pixels.y);
  ivec2 cell = ivec2(pixel) & 3;
  float turn = float((cell.x * 4 + ((cell.x & 1) == 0 ? cell.y : 3 - cell.y)) * 7 % 16) * (6.2831853 / 16.0);
  float sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    float share = (float(i) + 0.5) / float(samples);
    float angle = turn + share * 6.2831853 * 5.0;
    ivec2 other = at + ivec2(share * reach_px * vec2(cos(angle), sin(angle)));
    other = clamp(other, ivec2(0), ivec2(pixels.xy) - 1);
    float other_depth = texelFetch(depths, other, 0).r;
    if (other_depth <= 0.0) continue;
    vec3 between = view_point(vec2(other) + 0.5, other_depth) - point;
    float squared = dot(between, between);
    float fall = max(reach * reach - squared, 0.0);
    sum += fall * fall * fall * max((dot(between, normal) - 0.02 * reach) / (0.01 * reach * reach + squared), 0.0);
  }
  float reach6 = reach * reach * reach * reach * reach * reach;
  return vec4(max(0.0, 1.0 - sum * reach * 3.2 / (reach6 * float(samples))));
}
