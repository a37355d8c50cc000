#pragma once
// Camera movement by mouse and keys, as functions on OrbitCamera. Pixels are those of the 3D view, from its
// top left corner.

#include <utility>
#include <vector>

#include "viewer/render/orbit_camera.h"

namespace collidoscope {

/// Orbits about the target for a drag of (dx, dy) pixels in a view of `height` pixels.
void orbit(OrbitCamera& camera, double dx, double dy, double height);
/// Pans: points at the target's distance stay under the pointer.
void pan(OrbitCamera& camera, double dx, double dy, double height);
/// Zooms by wheel `steps`, > 0 nearer. The point under the pointer at the target's distance stays in place.
void zoom(OrbitCamera& camera, double steps, double x, double y, double width, double height, double nearest,
          double farthest);
/// Moves eye and target in metres along right, up and forward.
void fly(OrbitCamera& camera, const Vector3d& metres);
/// Rotates the view direction about the eye.
void look(OrbitCamera& camera, double dx, double dy, double height);

/// Views from -y, from +x, from above.
enum class AxisView { front, side, top };
void look_along(OrbitCamera& camera, AxisView view);

/// Outline of a sphere in pixels of the view. Empty if the eye is inside the sphere or the sphere is behind
/// it.
std::vector<std::pair<double, double>> sphere_outline(const OrbitCamera& camera, const Vector3d& center,
                                                      double radius, double width, double height);

}  // namespace collidoscope
