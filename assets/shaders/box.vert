// The twelve edges of a box as screen-space lines, coloured by level, thin and faint as levels deepen; or by the value
// of a metric, thin and faint where that is small, so that the worst stand out.
// Compiled four times: lines (default); THIN, lines of one drawn pixel, of those boxes that line_cull.comp lists; and
// IDS, the six faces filled with the number of the instance, or EDGES, its lines.
uniform vec4 range;  // least and greatest value drawn

#if defined(IDS)
layout(location = 0) in vec4 min_level;
layout(location = 1) in vec4 max_value;

flat out uint body;

void main() {
  body = 0x80000000u + uint(gl_InstanceID);
#if defined(EDGES)
  int corner = gl_VertexID >> 1, axis = corner >> 2;
  bvec3 upper;
  upper[axis] = (gl_VertexID & 1) == 1;
#else
  int face = gl_VertexID / 6, axis = face >> 1;
  const int order[6] = int[6](0, 1, 2, 2, 1, 3);
  int corner = order[gl_VertexID % 6];
  bvec3 upper;
  upper[axis] = (face & 1) == 1;
#endif
  upper[(axis + 1) % 3] = (corner & 1) == 1;
  upper[(axis + 2) % 3] = (corner & 2) == 2;
  gl_Position = projection * (view * vec4(mix(min_level.xyz, max_value.xyz, upper), 1.0));
  if (max_value.w < range.x || max_value.w > range.y) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
}
#else
struct Box {
  vec4 min_level, max_value;
};
layout(std430, binding = 0) readonly buffer Boxes { Box boxes[]; };
layout(binding = 0) uniform sampler2D colors;

uniform int first;       // record to begin with
#if defined(THIN)
layout(std430, binding = 3) readonly buffer Listed {
  uint command[4];
  uint count;     // of those that may be seen
  uint listed[];  // their places behind the first
};
#else
uniform int count;       // records to draw
#endif
uniform float strength;  // opacity of this pass
uniform vec4 levels;     // first and last level drawn, and the one that is highlighted, or -1
uniform vec4 coloring;   // of values: from and scale; 0 coloured by level, 1 by value, 2 by its logarithm, 3: a mark,
                         // 4: a wall; drawn pixels to each side of the worst

flat out vec4 color;
flat out float half_width;
noperspective out float across;

void main() {
#if defined(THIN)
  const int vertices = 2;  // of a line
#else
  const int vertices = 6;
#endif
  // Backwards: where edges coincide, the line of the upper level lies on top, and is the thicker one.
  int from_last = gl_VertexID / (12 * vertices), vertex = gl_VertexID % (12 * vertices);
#if defined(THIN)
  int place = first + int(listed[count - 1 - from_last]);
#else
  int place = first + count - 1 - from_last;
#endif
  vec4 min_level = boxes[place].min_level, max_value = boxes[place].max_value;
  int edge = vertex / vertices, axis = edge >> 2;
  bvec3 upper;
  upper[(axis + 1) % 3] = (edge & 1) == 1;
  upper[(axis + 2) % 3] = (edge & 2) == 2;
  upper[axis] = false;
  vec3 from = mix(min_level.xyz, max_value.xyz, upper);
  upper[axis] = true;
  vec3 to = mix(min_level.xyz, max_value.xyz, upper);
  float level = min_level.w;
  float depth_share = clamp((level - levels.x) / max(levels.y - levels.x, 1.0), 0.0, 1.0);
  color = vec4(level_colors[clamp(int(level), 0, 63)].rgb, strength * mix(1.0, 0.85, depth_share));
  half_width = mix(1.4, 0.6, depth_share);
  if (coloring.z == 4.0) {
    color.rgb = vec3(0.95, 0.96, 0.98);
  } else if (coloring.z == 3.0) {
    int mark = int(max_value.w);
    if (mark > 0) {
      color = vec4(marks[mark].rgb, strength);
      half_width = marks[mark].w;
    }
  } else if (coloring.z > 0.0) {
    float at = color_place(max_value.w, coloring.x, coloring.y, coloring.z == 2.0);
    color = vec4(map_color(colors, at), strength * mix(0.4, 1.0, at));
    half_width = mix(0.5, coloring.w, at * at);
  }
  if (levels.z >= 0.0 && level != levels.z) color.a *= 0.12;
#if defined(THIN)
  half_width = 0.5;
  across = 0.0;
  gl_Position = projection * (view * vec4(vertex % vertices == 0 ? from : to, 1.0));
#else
  half_width *= values.w;
  gl_Position = line_corner(from, to, half_width, vertex % vertices, across);
#endif
  gl_Position.z *= 1.0008;  // lines on a surface win over it
  if (max_value.w < range.x || max_value.w > range.y) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
}
#endif
