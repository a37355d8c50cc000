// Bodies drawn by their faces, flat-shaded, each at its own place.
layout(location = 0) in vec4 center_radius;
layout(location = 1) in vec4 orientation;  // unit quaternion x y z w
layout(location = 2) in float value;
layout(location = 3) in uint id;
layout(location = 4) in vec3 vertex;  // m, from the centre of mass
layout(location = 5) in vec3 face_normal;

layout(binding = 0) uniform sampler2D colors;

flat out vec3 normal;
flat out vec3 albedo;
flat out uint body;

vec3 turn(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

void main() {
  normal = turn(orientation, face_normal);
  body = id;
  albedo = body_color(colors, value, id);
  gl_Position = projection * (view * vec4(center_radius.xyz + turn(orientation, vertex), 1.0));
}
