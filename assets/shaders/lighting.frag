// A soft studio: sky above, warm floor below, one key light with a soft shadow, a faint rim; on a dark backdrop.
// As fragment shaders, there are two: of what was drawn (default), and BACKDROP, where nothing was. The depth test
// selects one of them, because a renderer on the CPU executes both sides of every branch. The compute shader does
// both. QUICK: fewer samples of the shadow map, and no powers.
layout(binding = 0) uniform sampler2D albedos;
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D depths;
layout(binding = 3) uniform sampler2D visibility;  // one texel for each picture pixel
layout(binding = 4) uniform sampler2DShadow shadows;

#if defined(QUICK)
// Fitted to the powers of frame.glsl: within 1/255.
vec3 quick_linear(vec3 srgb) { return srgb * srgb * (0.744 + 0.2593 * srgb); }
vec3 quick_srgb(vec3 light) {
  vec3 root = sqrt(light);
  return 0.9959 * root + 0.0737 * sqrt(root) - 0.0690 * light;
}
float fourth(float x) { return x * x * x * x; }
float sixtieth(float x) { return fourth(fourth(fourth(x))); }
#define to_linear quick_linear
#define to_srgb quick_srgb
#else
float fourth(float x) { return pow(x, 4.0); }
float sixtieth(float x) { return pow(x, 60.0); }
#endif

vec3 backdrop(vec2 pixel) {
  vec2 at = pixel * pixels.zw;
  vec3 low = vec3(0.0150, 0.0170, 0.0205), high = vec3(0.0440, 0.0500, 0.0600);
  float from_middle = length((at - vec2(0.5, 0.55)) * vec2(1.0, 0.9));
  return mix(high, low, smoothstep(0.0, 0.85, from_middle));
}

float key_light(vec3 point, vec3 normal) {
  float texel = key.w / float(textureSize(shadows, 0).x);
  vec4 clip = light_clip * vec4(point + normal * texel * 2.5, 1.0);
  vec3 at = vec3(clip.xy * 0.5 + 0.5, clip.z);
  if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
  const vec2 disc[12] = vec2[12](vec2(-0.326, -0.406), vec2(-0.840, -0.074), vec2(-0.696, 0.457), vec2(-0.203, 0.621),
                                 vec2(0.962, -0.195), vec2(0.473, -0.480), vec2(0.519, 0.767), vec2(0.185, -0.893),
                                 vec2(0.507, 0.064), vec2(0.896, 0.412), vec2(-0.322, -0.933), vec2(-0.792, -0.598));
#if defined(QUICK)
  const int taps = 3;
#else
  const int taps = 12;
#endif
  float lit = 0.0;
  for (int i = 0; i < taps; ++i) lit += textureLod(shadows, vec3(at.xy + disc[i] * (2.2 / float(textureSize(shadows, 0).x)), at.z), 0.0);
  return lit / float(taps);
}

vec4 on_screen(vec3 color, vec2 pixel) {
  // Half a step of ordered noise keeps the dark gradient from banding.
  float noise = fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))) - 0.5;
  color = color / (1.0 + max(color - 0.75, 0.0) * 0.55);  // highlights bend before they clip
  return vec4(to_srgb(color) + noise / 255.0, 1.0);
}

#if defined(BACKDROP)
vec4 shade(vec2 pixel) { return on_screen(backdrop(pixel), pixel); }
#else
vec4 shade(vec2 pixel) {
  ivec2 at = ivec2(pixel);
  float depth = texelFetch(depths, at, 0).r;
#if defined(COMPUTED_FORMAT)
  if (depth <= 0.0) return on_screen(backdrop(pixel), pixel);
#endif
  vec4 albedo = texelFetch(albedos, at, 0);
  vec3 normal = normalize(texelFetch(normals, at, 0).xyz * 2.0 - 1.0);
  vec3 in_view = view_point(pixel, depth);
  vec3 point = (inverse_view * vec4(in_view, 1.0)).xyz;
  vec3 eye_side = lens.z > 0.5 ? mat3(inverse_view) * normalize(-in_view) : inverse_view[2].xyz;
  float open = texelFetch(visibility, at / int(values.w), 0).r;
  float facing = dot(normal, key.xyz);
  float lit = facing > 0.0 ? key_light(point, normal) : 0.0;
  vec3 color;
  if (albedo.a > 0.9) {
    vec3 base = to_linear(albedo.rgb);
    vec3 sky = mix(vec3(0.23, 0.20, 0.18), vec3(0.56, 0.62, 0.72), normal.z * 0.5 + 0.5);
    vec3 light = sky * open * 0.95 + vec3(1.62, 1.52, 1.36) * max(facing, 0.0) * lit;
    color = base * light;
    vec3 halfway = normalize(key.xyz + eye_side);
    float grazing = fourth(1.0 - max(dot(normal, eye_side), 0.0));
    color += vec3(0.22) * lit * sixtieth(max(dot(normal, halfway), 0.0));
    color += vec3(0.16, 0.19, 0.24) * grazing * open * (0.35 + 0.65 * max(normal.z, 0.0));
  } else {
    float shown = clamp((albedo.a - 0.25) * 2.0, 0.0, 1.0);
    vec3 base = mix(vec3(0.085, 0.092, 0.105), vec3(0.34, 0.37, 0.42), albedo.r);
    vec3 light = vec3(0.46) * open + vec3(0.72, 0.70, 0.66) * lit * min(1.3 * max(facing, 0.0), 1.0);
    color = mix(backdrop(pixel), base * light, shown);
  }
  return on_screen(color, pixel);
}
#endif
