flat in vec3 normal;
flat in vec3 albedo;
flat in uint body;

#if defined(SURFACE)
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_normal;
#elif defined(IDS)
layout(location = 0) out uint out_id;
#endif

void main() {
#if defined(SURFACE)
  out_albedo = vec4(albedo, 1.0);
  out_normal = vec4(normalize(normal) * 0.5 + 0.5, 1.0);
#elif defined(IDS)
  out_id = body + 1u;
#endif
}
