// Ray-casts the sphere: exact outline, depth and normal. Compiled thrice: SURFACE, IDS, SHADOW.
flat in Sphere sphere;
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
#if defined(SHADOW)
  // The light looks in parallel: half the work of the general case, which counts where the CPU draws.
  vec2 off = (gl_FragCoord.xy * pixels.zw * 2.0 - 1.0) * lens.xy - sphere.center.xy;
  float inside = sphere.radius * sphere.radius - dot(off, off);
  if (inside < 0.0) discard;
  gl_FragDepth = projection[2][2] * (sphere.center.z + sqrt(inside)) + projection[3][2];
#else
  vec3 point, normal;
  if (!sphere_at(sphere, gl_FragCoord.xy, point, normal)) discard;
  gl_FragDepth = depth_of(point);
#if defined(SURFACE)
  out_albedo = vec4(albedo, 1.0);
  out_normal = vec4(mat3(inverse_view) * normal * 0.5 + 0.5, 1.0);
#elif defined(IDS)
  out_id = body + 1u;
#endif
#endif
}
