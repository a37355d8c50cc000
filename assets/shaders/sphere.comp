// Spheres by compute: first the nearest depth in every pixel, then, among those that have it, the first body; so the
// order in which they come leaves no trace, and the picture is that of sphere.frag. Compiled twice: each lane walks
// over the pixels of one small sphere and puts large ones on a list (default), workgroups walk over those (LARGE).
layout(local_size_x = 128) in;

struct Body {
  vec4 center_radius, orientation;
  float value;
  uint id, mesh, padding;
};
layout(std430, binding = 0) readonly buffer Bodies { Body bodies[]; };
layout(std430, binding = 1) buffer Larges {
  uint large_count, huge_count;  // the list begins with the large ones and ends with the huge ones
  uint larges[];
};
layout(binding = 0, r32ui) uniform coherent uimage2D nearest;  // depth as bits, which keep the order of what is not negative
layout(binding = 1, r32ui) uniform coherent uimage2D owners;   // place of the body

uniform int body_count;
uniform int second_round;      // 1: owners; 0: nearest
uniform int at_least_a_pixel;  // 1 but for shadows

const int small_pixels = 256, large_pixels = 128 * 128;  // at most, of the square around

struct Visit {
  Sphere sphere;
  ivec2 from, to;  // pixels, inclusive
  uint front;      // depth that none of it is before
};

// Where an outline lies along one axis of the picture, at distance 1 (Mara and McGuire 2013); orthographic: in m.
vec2 extent(float along, float depth, float radius) {
  if (lens.z < 0.5) return vec2(along - radius, along + radius);
  float tangent = depth * depth - radius * radius;
  if (depth <= 0.0 || tangent <= 1e-4 * radius * radius) return vec2(-1e9, 1e9);  // reaches the plane of the eye
  float reach = radius * sqrt(along * along + tangent);
  return vec2(along * depth - reach, along * depth + reach) / tangent;
}

// False where it is not in the picture.
bool prepare(int place, out Visit visit) {
  vec3 center = (view * vec4(bodies[place].center_radius.xyz, 1.0)).xyz;
  visit.sphere = sphere_shown(center, bodies[place].center_radius.w, at_least_a_pixel == 1);
  float radius = visit.sphere.least;
  if (bodies[place].mesh != 0u || (lens.z > 0.5 && center.z > radius)) return false;
  vec2 x = extent(center.x, -center.z, radius), y = extent(center.y, -center.z, radius);
  vec2 low = (vec2(x.x, y.x) / lens.xy * 0.5 + 0.5) * pixels.xy, high = (vec2(x.y, y.y) / lens.xy * 0.5 + 0.5) * pixels.xy;
  const float rounding = 0.02;  // pixels
  visit.from = ivec2(clamp(ceil(low - 0.5 - rounding), vec2(0.0), pixels.xy));
  visit.to = ivec2(clamp(floor(high - 0.5 + rounding), vec2(-1.0), pixels.xy - 1.0));
  bool crosses = lens.z > 0.5 && center.z + radius > -lens.w;
  visit.front = floatBitsToUint(crosses ? 1.0 : clamp(1.0001 * depth_of(center + vec3(0.0, 0.0, radius)), 0.0, 1.0));
  return all(lessThanEqual(visit.from, visit.to));
}

void draw(int place, Visit visit, ivec2 pixel) {
  uint seen = imageLoad(nearest, pixel).r;
  vec3 point, normal;
  if (seen > visit.front || !sphere_at(visit.sphere, vec2(pixel) + 0.5, point, normal)) return;
  uint depth = floatBitsToUint(clamp(depth_of(point), 0.0, 1.0));
  if (second_round == 0 && depth > seen) imageAtomicMax(nearest, pixel, depth);
  if (second_round == 1 && depth == seen) imageAtomicMin(owners, pixel, uint(place));
}

#if defined(LARGE)
uniform int huge;  // 1: the huge ones, each shared by the workgroups of a column

void main() {
  int count = int(huge == 1 ? huge_count : large_count);
  for (int k = int(gl_WorkGroupID.x); k < count; k += int(gl_NumWorkGroups.x)) {
    int place = int(larges[huge == 1 ? body_count - 1 - k : k]);
    Visit visit;
    if (!prepare(place, visit)) continue;
    ivec2 size = visit.to - visit.from + 1;
    for (int i = int(gl_GlobalInvocationID.y * gl_WorkGroupSize.x + gl_LocalInvocationID.x); i < size.x * size.y;
         i += int(gl_NumWorkGroups.y * gl_WorkGroupSize.x))
      draw(place, visit, visit.from + ivec2(i % size.x, i / size.x));
  }
}
#else
void main() {
  for (int place = int(gl_GlobalInvocationID.x); place < body_count; place += int(gl_NumWorkGroups.x * gl_WorkGroupSize.x)) {
    Visit visit;
    if (!prepare(place, visit)) continue;
    ivec2 size = visit.to - visit.from + 1;
    if (size.x * size.y <= small_pixels) {
      for (int y = visit.from.y; y <= visit.to.y; ++y)
        for (int x = visit.from.x; x <= visit.to.x; ++x) draw(place, visit, ivec2(x, y));
    } else if (second_round == 0) {
      if (size.x * size.y <= large_pixels)
        larges[atomicAdd(large_count, 1u)] = uint(place);
      else
        larges[uint(body_count) - 1u - atomicAdd(huge_count, 1u)] = uint(place);
    }
  }
}
#endif
