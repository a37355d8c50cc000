// A shell of glass: nearly nothing in the middle, a bright outline. All ghosts have one colour, so that their order
// does not matter.
flat in vec3 center;
flat in float radius;
flat in float opacity;

uniform vec4 tint;

layout(location = 0) out vec4 out_color;

void main() {
  Ray ray = ray_through(gl_FragCoord.xy);
  vec3 to_center = center - ray.origin;
  float along = dot(to_center, ray.direction);
  float off = length(to_center - along * ray.direction);  // m, of the ray from the centre
  float pixel = 2.0 * lens.y * pixels.w * (lens.z > 0.5 ? max(-center.z, lens.w) : 1.0);
  float covered = clamp((radius - off) / pixel + 0.5, 0.0, 1.0);
  float within = clamp((radius - off) / pixel - 1.3 * values.w + 0.5, 0.0, 1.0);  // of the outline's inner edge
  float rim = min(off / radius, 1.0);
  float shell = mix(0.05, 0.34, rim * rim * rim);
  float alpha = opacity * covered * mix(0.9, shell, within);
  if (alpha <= 0.002) discard;
  float hit = along - sqrt(max(radius * radius - off * off, 0.0));
  gl_FragDepth = min(depth_of(ray.origin + hit * ray.direction) * 1.0004, 1.0);
  out_color = vec4(tint.rgb, alpha);
}
