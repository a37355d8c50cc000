// Which boxes or contacts may be seen: lists their places, in order, for an indirect draw. Left out is only what can
// leave no mark: all of it lies outside of the picture, or behind the surfaces.
// Compiled as MARK (a rank within its group for each that may be seen, and their number), with CONTACTS or without; SUM
// (one group: the numbers become starts); and LIST.
layout(local_size_x = 256) in;

layout(std430, binding = 1) buffer Ranks { uint rank[]; };  // in its group; 0xffffffff: not seen
layout(std430, binding = 2) buffer Groups { uint starts[]; };
layout(std430, binding = 3) buffer Listed {
  uint vertices, instances, first_vertex, first_instance;  // what glDrawArraysIndirect() reads
  uint listed_count;
  uint listed[];
};
uniform int count;

shared uint sums[256];

// Sums of what the lanes before give; of all in `total`.
uint sum_before(uint value, out uint total) {
  uint lane = gl_LocalInvocationIndex;
  sums[lane] = value;
  barrier();
  for (uint reach = 1; reach < 256; reach *= 2) {
    uint sum = sums[lane] + (lane >= reach ? sums[lane - reach] : 0);
    barrier();
    sums[lane] = sum;
    barrier();
  }
  total = sums[255];
  uint before = sums[lane] - value;
  barrier();
  return before;
}

#if defined(MARK)
layout(binding = 1) uniform sampler2D tiles;
uniform int first, cull;  // 0: all count as seen
uniform vec4 range;  // least and greatest value drawn

#if defined(CONTACTS)
struct Contact {
  vec4 point_penetration, normal_impulse;
  uvec2 bodies;
  float size, padding;
};
layout(std430, binding = 0) readonly buffer Contacts { Contact contacts[]; };
#else
struct Box {
  vec4 min_level, max_value;
};
layout(std430, binding = 0) readonly buffer Boxes { Box boxes[]; };
#endif

// `room`: drawn pixels by which lines reach beyond.
bool may_be_seen(vec3 low, vec3 high, float room) {
  vec2 from = vec2(1e30), to = vec2(-1e30);
  float nearest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    vec4 at = projection * (view * vec4(mix(low, high, bvec3(corner & 1, corner & 2, corner & 4)), 1.0));
    if (at.w - 1.001 * at.z <= 0.0) return true;  // it reaches before the near plane
    vec3 p = at.xyz / at.w;
    from = min(from, p.xy);
    to = max(to, p.xy);
    nearest = max(nearest, p.z);
  }
  from = (0.5 * from + 0.5) * pixels.xy - room;
  to = (0.5 * to + 0.5) * pixels.xy + room;
  if (any(lessThan(to, vec2(0.0))) || any(greaterThan(from, pixels.xy))) return false;
  ivec2 last = textureSize(tiles, 0) - 1;
  ivec2 a = clamp(ivec2(floor(max(from, vec2(0.0)) / 8.0)), ivec2(0), last);
  ivec2 b = clamp(ivec2(floor(min(to, pixels.xy) / 8.0)), ivec2(0), last);
  if ((b.x - a.x + 1) * (b.y - a.y + 1) > 64) return true;
  // Lines on a surface win over it by 1.0008; a little more, for what rounds.
  nearest *= 1.001;
  for (int y = a.y; y <= b.y; ++y)
    for (int x = a.x; x <= b.x; ++x)
      if (nearest >= texelFetch(tiles, ivec2(x, y), 0).r) return true;
  return false;
}

bool seen(int place) {
#if defined(CONTACTS)
  vec3 point = contacts[place].point_penetration.xyz;
  float distance = lens.z > 0.5 ? max(-(view * vec4(point, 1.0)).z, lens.w) : 1.0;
  float pixel = 2.0 * lens.y * pixels.w * distance;  // m
  float reach = max(contacts[place].size, 6.0 * values.w * pixel);
  return may_be_seen(point - reach, point + reach, 4.0 * values.w);
#else
  float value = boxes[place].max_value.w;
  return value >= range.x && value <= range.y && may_be_seen(boxes[place].min_level.xyz, boxes[place].max_value.xyz, 2.0);
#endif
}

void main() {
  uint place = gl_GlobalInvocationID.x, total;
  bool mine = place < uint(count) && (cull == 0 || seen(first + int(place)));
  uint before = sum_before(mine ? 1 : 0, total);
  if (place < uint(count)) rank[place] = mine ? before : 0xffffffffu;
  if (gl_LocalInvocationIndex == 0) starts[gl_WorkGroupID.x] = total;
}
#elif defined(SUM)
uniform int vertices_each;
void main() {
  uint sum = 0, groups = (uint(count) + 255) / 256, total;
  for (uint start = 0; start < groups; start += 256) {
    uint group = start + gl_LocalInvocationIndex, own = group < groups ? starts[group] : 0;
    uint before = sum_before(own, total);
    if (group < groups) starts[group] = sum + before;
    sum += total;
  }
  if (gl_LocalInvocationIndex > 0) return;
  vertices = sum * uint(vertices_each);
  instances = 1;
  first_vertex = first_instance = 0;
  listed_count = sum;
}
#else
void main() {
  uint place = gl_GlobalInvocationID.x;
  if (place < uint(count) && rank[place] != 0xffffffffu) listed[starts[gl_WorkGroupID.x] + rank[place]] = place;
}
#endif
