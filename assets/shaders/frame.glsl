// What all passes share. Kept in step with FrameUniforms in viewer/render/frame_uniforms.h.
// World: metres, z up. View: x right, y up, z towards the eye. Depth is reversed: 1 at the near plane, 0 far away.

layout(std140, binding = 0) uniform Frame {
  mat4 view;
  mat4 projection;
  mat4 inverse_view;
  mat4 light_clip;       // world to the clip space of the key light's shadow map
  vec4 pixels;           // width, height, 1 / width, 1 / height of what is drawn into
  vec4 lens;             // half extents of the picture at distance 1 (orthographic: in m), 1 if perspective, near
  vec4 key;              // towards the key light, world; w: width of the shadow map, m
  vec4 values;           // least value, 1 / (greatest - least), 1 if coloured by id, 2 if by the logarithm, drawn pixels per picture pixel
  vec4 scale;            // reach of ambient occlusion m, grid spacing m, 1 / impulse of the strongest contact (0: unknown), unused
  vec4 level_colors[64];   // of the hierarchy's levels
  vec4 contact_colors[3];  // weak, middling, strong
  vec4 marks[7];           // colours of boxes drawn on top, and pixels to each side of their lines
};

struct Ray {
  vec3 origin, direction;  // view space; direction of unit length
};

Ray ray_through(vec2 pixel) {
  vec2 at = (pixel * pixels.zw * 2.0 - 1.0) * lens.xy;
  if (lens.z > 0.5) return Ray(vec3(0.0), normalize(vec3(at, -1.0)));
  return Ray(vec3(at, 0.0), vec3(0.0, 0.0, -1.0));
}

// Distance along the ray to the near side of a sphere, or -1: missed, or the eye is inside. The distance of the
// centre from the ray is taken first, which keeps its digits for small spheres far away.
float hit_sphere(Ray ray, vec3 center, float radius) {
  vec3 to_center = center - ray.origin;
  float along = dot(to_center, ray.direction);
  vec3 across = to_center - along * ray.direction;
  float inside = radius * radius - dot(across, across);
  if (inside < 0.0) return -1.0;
  float hit = along - sqrt(inside);
  return hit > lens.w ? hit : -1.0;
}

// A sphere as it is drawn, in view space. In the pixel that holds its centre it is at least `least` in radius, which
// covers the middle of that pixel: none falls between the samples. Of a sphere that is larger anyway nothing changes.
struct Sphere {
  vec3 center;
  float radius, least;
  ivec2 own;  // that pixel
};

Sphere sphere_shown(vec3 center, float radius, bool at_least_a_pixel) {
  float distance = lens.z > 0.5 ? -center.z : 1.0;
  float pixel = 2.0 * lens.y * pixels.w * distance;  // m
  if (!at_least_a_pixel || distance <= 0.0 || radius >= 0.75 * pixel) return Sphere(center, radius, radius, ivec2(-1));
  return Sphere(center, radius, 0.75 * pixel, ivec2(floor(center.xy / pixel + 0.5 * pixels.xy)));
}

// The point of it that the middle of a pixel shows, and the normal there; false where it shows none.
bool sphere_at(Sphere s, vec2 pixel, out vec3 point, out vec3 normal) {
  Ray ray = ray_through(pixel);
  float radius = ivec2(pixel) == s.own ? s.least : s.radius;
  float hit = hit_sphere(ray, s.center, radius);
  point = ray.origin + hit * ray.direction;
  normal = (point - s.center) / radius;
  return hit >= 0.0;
}

float depth_of(vec3 view_point) {
  vec4 clip = projection * vec4(view_point, 1.0);
  return clip.z / clip.w;
}

vec3 view_point(vec2 pixel, float depth) {
  vec2 at = (pixel * pixels.zw * 2.0 - 1.0) * lens.xy;
  if (lens.z > 0.5) {
    float distance = projection[3][2] / depth;
    return vec3(at * distance, -distance);
  }
  return vec3(at, (depth - projection[3][2]) / projection[2][2]);
}

vec3 to_linear(vec3 srgb) { return pow(srgb, vec3(2.2)); }
vec3 to_srgb(vec3 linear_light) { return pow(max(linear_light, 0.0), vec3(1.0 / 2.2)); }

// One corner (0 to 5: two triangles) of the quad that draws a line `half_width` drawn pixels wide to each side,
// with a pixel of room for its soft edge. `across` runs over the width, in drawn pixels, 0 on the line.
vec4 line_corner(vec3 from, vec3 to, float half_width, int corner, out float across) {
  const int order[6] = int[6](0, 1, 2, 2, 1, 3);
  int i = order[corner];
  vec4 a = projection * (view * vec4(from, 1.0)), b = projection * (view * vec4(to, 1.0));
  float room_a = a.w - 1.001 * a.z, room_b = b.w - 1.001 * b.z;  // > 0 beyond the near plane
  across = 0.0;
  if (room_a <= 0.0 && room_b <= 0.0) return vec4(0.0, 0.0, 0.0, 1.0);
  if (room_a < 0.0) a = mix(a, b, room_a / (room_a - room_b));
  if (room_b < 0.0) b = mix(b, a, room_b / (room_b - room_a));
  vec2 screen_a = a.xy / a.w * pixels.xy * 0.5, screen_b = b.xy / b.w * pixels.xy * 0.5;
  vec2 direction = screen_b - screen_a;
  float length_px = length(direction);
  direction = length_px > 1e-4 ? direction / length_px : vec2(1.0, 0.0);
  float reach = half_width + 1.0;
  across = (i & 1) == 0 ? -reach : reach;
  vec4 end = (i >> 1) == 0 ? a : b;
  float cap = (i >> 1) == 0 ? -half_width : half_width;
  vec2 offset = across * vec2(-direction.y, direction.x) + cap * direction;
  end.xy += offset * 2.0 * pixels.zw * end.w;
  return end;
}

// How much of a pixel a line covers.
float line_coverage(float across, float half_width) {
  return clamp(half_width + 0.5 - abs(across), 0.0, 1.0) * min(1.0, 2.0 * half_width);
}

// Where a value lies on the colour map, 0 to 1 (ColorScale in viewer/render/frame_uniforms.h).
float color_place(float value, float from, float scale, bool logarithmic) {
  return clamp(((logarithmic ? log(max(value, 1e-30)) : value) - from) * scale, 0.0, 1.0);
}

vec3 map_color(sampler2D colors, float at) {
  return textureLod(colors, vec2((at * 255.0 + 0.5) / 256.0, 0.5), 0.0).rgb;
}

// A body's colour: of its value by the map in `colors`, or of its id: neighbours in number lie far apart on the
// colour wheel, by steps of the golden angle.
vec3 body_color(sampler2D colors, float value, uint id) {
  if (values.z == 1.0) {
    float turn = fract(float(id % 4096u) * 0.618034) * 6.2831853;
    return 0.58 + 0.30 * cos(turn - vec3(0.0, 2.0944, 4.1888));
  }
  return map_color(colors, color_place(value, values.x, values.y, values.z == 2.0));
}

// Passes over a whole picture define shade(), the value of the pixel with this middle. They are fragment shaders,
// or, with COMPUTED_FORMAT, compute shaders (viewer/render/gl/pixel_pass.h).
#if defined(EACH_PIXEL) && !defined(VERTEX_STAGE)
vec4 shade(vec2 pixel);
#if defined(COMPUTED_FORMAT)
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, COMPUTED_FORMAT) writeonly uniform image2D computed;
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(computed)))) return;
  imageStore(computed, at, shade(vec2(at) + 0.5));
}
#else
layout(location = 0) out vec4 shaded;
void main() { shaded = shade(gl_FragCoord.xy); }
#endif
#endif
