#pragma once
// The camera: an orbit about a target, in metres and radians. z is up unless the scene sets another
// direction.

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

struct Bounds {
  Vector3d min{0, 0, 0}, max{1, 1, 1};
  Vector3d center() const { return 0.5 * (min + max); }
  double diagonal() const { return (max - min).norm(); }
};

struct OrbitCamera {
  Vector3d target{0, 0, 0};
  Vector3d up{0, 0, 1};
  double azimuth = -0.96;      ///< rad, angle of the eye about `up`
  double elevation = 0.36;     ///< rad, angle above the plane orthogonal to `up`
  double distance = 10;        ///< m, from the target to the eye
  double field_of_view = 0.6;  ///< rad, vertical angle of view
  bool orthographic = false;   ///< the height of the picture matches the perspective at the target

  friend bool operator==(const OrbitCamera&, const OrbitCamera&) = default;

  Vector3d eye() const;
  Matrix3d axes() const;         ///< columns: right, up, backward (from the target to the eye)
  Eigen::Matrix4d view() const;  ///< world to view space: x right, y up, z towards the eye
  /// View to clip space with reversed depth: 1 at `near`, 0 at infinity (orthographic: at `far`).
  Eigen::Matrix4d projection(double aspect, double near, double far) const;
};

/// Moves the eye along the view direction to the nearest position that shows all of `bounds`, with a margin.
OrbitCamera frame_all(const Bounds& bounds, double aspect, OrbitCamera from = {}, double margin = 1.1);

/// Camera of the scene file. Values that it does not set frame the bounds.
OrbitCamera scene_camera(const Camera& request, const Bounds& bounds, double aspect);

}  // namespace collidoscope
