// The twelve edges of a box as screen-space lines, coloured by level; thin and faint as levels deepen.
// Compiled twice: lines (default) and IDS, the six faces filled with the number of the instance.
#if defined(IDS)
layout(location = 0) in vec4 min_level;
layout(location = 1) in vec4 max_value;

flat out uint body;

void main() {
  body = 0x80000000u + uint(gl_InstanceID);
  int face = gl_VertexID / 6, axis = face >> 1;
  const int order[6] = int[6](0, 1, 2, 2, 1, 3);
  int corner = order[gl_VertexID % 6];
  bvec3 upper;
  upper[axis] = (face & 1) == 1;
  upper[(axis + 1) % 3] = (corner & 1) == 1;
  upper[(axis + 2) % 3] = (corner & 2) == 2;
  gl_Position = projection * (view * vec4(mix(min_level.xyz, max_value.xyz, upper), 1.0));
}
#else
struct Box {
  vec4 min_level, max_value;
};
layout(std430, binding = 0) readonly buffer Boxes { Box boxes[]; };

uniform int box_count;
uniform float strength;  // opacity of this pass
uniform vec4 levels;     // first and last level drawn

flat out vec4 color;
flat out float half_width;
noperspective out float across;

void main() {
  // Backwards: where edges coincide, the line of the upper level lies on top, and is the thicker one.
  vec4 min_level = boxes[box_count - 1 - gl_InstanceID].min_level;
  vec4 max_value = boxes[box_count - 1 - gl_InstanceID].max_value;
  int edge = gl_VertexID / 6, axis = edge >> 2;
  bvec3 upper;
  upper[(axis + 1) % 3] = (edge & 1) == 1;
  upper[(axis + 2) % 3] = (edge & 2) == 2;
  upper[axis] = false;
  vec3 from = mix(min_level.xyz, max_value.xyz, upper);
  upper[axis] = true;
  vec3 to = mix(min_level.xyz, max_value.xyz, upper);
  float level = min_level.w;
  float depth_share = clamp((level - levels.x) / max(levels.y - levels.x, 1.0), 0.0, 1.0);
  half_width = mix(1.4, 0.6, depth_share) * values.w;
  color = vec4(level_colors[int(level) & 7].rgb, strength * mix(1.0, 0.85, depth_share));
  gl_Position = line_corner(from, to, half_width, gl_VertexID % 6, across);
  gl_Position.z *= 1.0008;  // lines on a surface win over it
}
#endif
