// Ray-casts the sphere: exact outline, depth and normal. Compiled thrice: SURFACE, IDS, SHADOW.
flat in vec3 center;
flat in float radius;
flat in vec3 albedo;
flat in uint body;

layout(depth_less) out float gl_FragDepth;
#if defined(SURFACE)
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_normal;
#elif defined(IDS)
layout(location = 0) out uint out_id;
#endif

void main() {
  Ray ray = ray_through(gl_FragCoord.xy);
  float distance = hit_sphere(ray, center, radius);
  if (distance < 0.0) discard;
  vec3 point = ray.origin + distance * ray.direction;
  gl_FragDepth = depth_of(point);
#if defined(SURFACE)
  vec3 normal = mat3(inverse_view) * ((point - center) / radius);
  out_albedo = vec4(albedo, 1.0);
  out_normal = vec4(normal * 0.5 + 0.5, 1.0);
#elif defined(IDS)
  out_id = body + 1u;
#endif
}
