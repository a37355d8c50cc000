// A surface of its own kind (albedo alpha 0.25 to 0.75): lit and shadowed like the bodies, then faded into the
// background. As a VEIL: fainter, blended over what lies behind.
struct Plane {
  vec4 normal_offset, center_radius, side_kind;
};
layout(std430, binding = 0) readonly buffer Planes { Plane planes[]; };

uniform int plane_count;
uniform vec4 box_min, box_max;  // obstacles end at the walls

in vec3 point;
in vec2 place;
flat in vec2 middle;
flat in int number;

#if defined(VEIL)
layout(location = 0) out vec4 out_color;
#else
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_normal;
#endif

float grid_lines(vec2 at, float spacing, float half_width) {
  vec2 cell = at / spacing;
  vec2 wide = max(fwidth(cell), 1e-6);
  vec2 from_line = abs(fract(cell + 0.5) - 0.5) / wide;  // drawn pixels
  vec2 covered = clamp(half_width + 0.5 - from_line, 0.0, 1.0) * min(vec2(1.0), 0.25 / wide);  // fades where too dense
  return max(covered.x, covered.y);
}

// What lies behind another plane, or an obstacle outside of the box, holds nobody.
bool out_of_reach(int kind, float slack) {
  if (kind == 0 && (any(lessThan(point, box_min.xyz - slack)) || any(greaterThan(point, box_max.xyz + slack)))) return true;
  for (int i = 0; i < plane_count; ++i) {
    vec4 other = planes[i].normal_offset;
    if (i != number && dot(other.xyz, point) - other.w < -slack) return true;
  }
  return false;
}

void main() {
  float line = max(0.55 * grid_lines(place, scale.y, 0.6 * values.w), 0.2 * grid_lines(place, scale.y * 0.2, 0.4 * values.w));
  float radius = planes[number].center_radius.w;
  float shown = 1.0 - smoothstep(0.45, 1.0, length(place - middle) / radius);
  int kind = int(planes[number].side_kind.w);
  if ((kind == 0 && shown <= 0.0) || out_of_reach(kind, 1e-4 * radius)) discard;
#if defined(VEIL)
  float fill = kind == 2 ? 0.0 : 0.10;
  out_color = vec4(mix(vec3(0.42, 0.46, 0.52), vec3(0.60, 0.65, 0.72), line), shown * shown * (fill + 0.45 * line));
#else
  out_albedo = vec4(vec3(line), 0.25 + 0.5 * shown * shown);  // colour is made in the lighting pass
  out_normal = vec4(planes[number].normal_offset.xyz * 0.5 + 0.5, 1.0);
#endif
}
