// Of each tile of 8 x 8 drawn pixels the farthest depth: what lies behind it is hidden in all of the tile.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D depth;
layout(binding = 0, r32f) writeonly uniform image2D tiles;

shared uint farthest;  // bits of a depth >= 0, which order as it does

void main() {
  if (gl_LocalInvocationIndex == 0) farthest = 0xffffffffu;
  barrier();
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(at, textureSize(depth, 0)))) atomicMin(farthest, floatBitsToUint(texelFetch(depth, at, 0).r));
  barrier();
  if (gl_LocalInvocationIndex == 0) imageStore(tiles, ivec2(gl_WorkGroupID.xy), vec4(uintBitsToFloat(farthest)));
}
