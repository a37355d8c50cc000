// A quad before each sphere that covers its whole outline, in perspective too; the fragment shader does the rest.
layout(location = 0) in vec4 center_radius;
layout(location = 2) in float value;
layout(location = 3) in uint id;

layout(binding = 0) uniform sampler2D colors;

flat out Sphere sphere;
flat out vec3 albedo;
flat out uint body;

void main() {
  vec3 center = (view * vec4(center_radius.xyz, 1.0)).xyz;
#if defined(SHADOW)
  sphere = sphere_shown(center, center_radius.w, false);
#else
  sphere = sphere_shown(center, center_radius.w, true);
#endif
  float radius = sphere.least;
  body = id;
  albedo = body_color(colors, value, id);

  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  bool perspective = lens.z > 0.5;
  float distance = length(center);
  if (perspective && center.z > radius) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // wholly behind the eye
    return;
  }
  if (perspective && distance < 2.0 * radius) {
    gl_Position = vec4(corner, 1.0, 1.0);  // so near that every pixel may see it
    return;
  }
  // The plane that touches the sphere before it, so that the depth found is never nearer than the quad's.
  vec3 away = perspective ? center / distance : vec3(0.0, 0.0, -1.0);
  vec3 side = normalize(cross(away, abs(away.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  vec3 up = cross(side, away);
  float reach = radius;
  if (perspective) reach = radius * (distance - radius) * inversesqrt(distance * distance - radius * radius);
  vec3 at = center - radius * away + 1.002 * reach * (corner.x * side + corner.y * up);
  gl_Position = projection * vec4(at, 1.0);
}
