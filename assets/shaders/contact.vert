// A contact: a ring in the tangent plane (corners 0 to 5) and a needle along the normal (6 to 11). The ring's colour
// and the needle's length and width go with the logarithm of the impulse, over three decades.
struct Contact {
  vec4 point_penetration, normal_impulse;
  uvec2 bodies;
  float size;  // m, radius of the smaller body
  float padding;
};
layout(std430, binding = 0) readonly buffer Contacts { Contact contacts[]; };

#if defined(LISTED)
layout(std430, binding = 3) readonly buffer Listed {
  uint command[4];
  uint count;
  uint listed[];  // places behind the first of those that may be seen
};
#endif
uniform int first;       // record to begin with
uniform float strength;  // opacity of this pass

flat out vec4 color;
flat out float half_width;
flat out float ring_px;            // radius of the ring in drawn pixels; 0: a needle
noperspective out float across;
out vec2 in_ring;                  // -1 to 1

void main() {
#if defined(LISTED)
  Contact contact = contacts[first + int(listed[gl_VertexID / 12])];
#else
  Contact contact = contacts[first + gl_VertexID / 12];
#endif
  int vertex = gl_VertexID % 12;
  float size = contact.size;
  vec3 point = contact.point_penetration.xyz, normal = contact.normal_impulse.xyz;
  vec3 in_view = (view * vec4(point, 1.0)).xyz;
  float metre_px = 0.5 * pixels.y / (lens.y * (lens.z > 0.5 ? max(-in_view.z, lens.w) : 1.0));
  float radius = max(0.38 * size, 3.0 * values.w / metre_px);
  int corner = vertex % 6;
  across = 0.0;
  in_ring = vec2(0.0);
  // 0 to 1; where impulses are not known, all are alike.
  float impulse = contact.normal_impulse.w * scale.z;
  float share = scale.z > 0.0 ? clamp(1.0 + log2(max(impulse, 1e-12)) / log2(1000.0), 0.0, 1.0) : 0.5;
  vec3 tint = share < 0.5 ? mix(contact_colors[0].rgb, contact_colors[1].rgb, 2.0 * share)
                                : mix(contact_colors[1].rgb, contact_colors[2].rgb, 2.0 * share - 1.0);
  half_width = mix(0.5, 1.1, share) * values.w;
  if (vertex < 6) {
    const int order[6] = int[6](0, 1, 2, 2, 1, 3);
    int i = order[corner];
    ring_px = radius * metre_px;
    float reach = radius * (1.0 + 1.5 * values.w / ring_px);
    vec3 side = normalize(cross(normal, abs(normal.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
    vec3 other = cross(normal, side);
    in_ring = (vec2(i & 1, i >> 1) * 2.0 - 1.0) * reach / radius;
    color = vec4(tint, strength);
    gl_Position = projection * (view * vec4(point + radius * (in_ring.x * side + in_ring.y * other), 1.0));
  } else {
    ring_px = 0.0;
    color = vec4(1.0, 0.94, 0.90, strength);
    float reach = max(mix(0.4, 1.0, share) * size, 6.0 * values.w / metre_px);
    gl_Position = line_corner(point - reach * normal, point + reach * normal, half_width, corner, across);
  }
  gl_Position.z *= 1.0004;
}
