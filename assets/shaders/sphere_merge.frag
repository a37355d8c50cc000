// What compute found (sphere.comp) becomes part of the picture: SURFACE, or depth alone (SHADOW).
struct Body {
  vec4 center_radius, orientation;
  float value;
  uint id, mesh, padding;
};
layout(std430, binding = 0) readonly buffer Bodies { Body bodies[]; };

layout(binding = 0) uniform sampler2D colors;
layout(binding = 1) uniform usampler2D nearest;
layout(binding = 2) uniform usampler2D owners;

#if defined(SURFACE)
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_normal;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uint depth = texelFetch(nearest, pixel, 0).r;
  if (depth == 0u) discard;
  gl_FragDepth = uintBitsToFloat(depth);
#if defined(SURFACE)
  Body body = bodies[texelFetch(owners, pixel, 0).r];
  vec3 center = (view * vec4(body.center_radius.xyz, 1.0)).xyz, point, normal;
  if (!sphere_at(sphere_shown(center, body.center_radius.w, true), gl_FragCoord.xy, point, normal)) {
    // Rounded otherwise than in compute, the ray just misses: the normal of the outline there.
    Ray ray = ray_through(gl_FragCoord.xy);
    normal = normalize(ray.origin + dot(center - ray.origin, ray.direction) * ray.direction - center);
  }
  out_albedo = vec4(body_color(colors, body.value, body.id), 1.0);
  out_normal = vec4(mat3(inverse_view) * normal * 0.5 + 0.5, 1.0);
#endif
}
