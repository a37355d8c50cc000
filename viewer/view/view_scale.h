#pragma once
// Resolution of the moving 3D view on a slow renderer: as many pixels as fit into a time budget. A value,
// updated with the time of each frame.

namespace collidoscope {

class ViewScale {
 public:
  /// s per drawing of the 3D view, for about 30 frames per second in total.
  static constexpr double budget = 0.025;

  /// Call when the view changes; `seconds` since the last change.
  void changed(double seconds) { hurried_ = seconds < 2 * whole_; }
  /// Records the drawing time at `scale`.
  void took(double scale, double seconds);
  /// Drawn pixels per shown pixel, along an axis: 5/8, 3/4, 7/8 or 1. 1 if there is enough time between
  /// changes.
  double scale() const { return hurried_ ? scale_ : 1; }

 private:
  double whole_ = 0;  ///< s, estimated drawing time at full resolution; 0: unknown
  double scale_ = 1;
  bool hurried_ = false;
};

}  // namespace collidoscope
