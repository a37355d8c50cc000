#pragma once
// How hands move the camera: values in, a camera out. Pixels are those of the 3D view, from its top left
// corner.

#include <utility>
#include <vector>

#include "viewer/render/orbit_camera.h"

namespace collidoscope {

/// A drag of that many pixels in a view `height` high turns about the target.
void orbit(OrbitCamera& camera, double dx, double dy, double height);
/// What lies at the target's distance stays under the pointer.
void pan(OrbitCamera& camera, double dx, double dy, double height);
/// `steps` of a wheel, > 0 nearer; what lies at the target's distance under the pointer stays there.
void zoom(OrbitCamera& camera, double steps, double x, double y, double width, double height, double nearest,
          double farthest);
/// Metres along right, up and forward: eye and target move together.
void fly(OrbitCamera& camera, const Vector3d& metres);
/// Turns about the eye, as one looks around.
void look(OrbitCamera& camera, double dx, double dy, double height);

/// From -y, from +x, from above.
enum class AxisView { front, side, top };
void look_along(OrbitCamera& camera, AxisView view);

/// The outline of a sphere as seen, in pixels of a view that large; empty if the eye is inside or it lies
/// behind.
std::vector<std::pair<double, double>> sphere_outline(const OrbitCamera& camera, const Vector3d& center,
                                                      double radius, double width, double height);

}  // namespace collidoscope
