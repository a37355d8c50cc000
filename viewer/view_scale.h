#pragma once
// How many pixels a slow renderer draws of the 3D view while it moves: as many as it can in time. A value,
// told how long each frame took.

namespace collidoscope {

class ViewScale {
 public:
  /// s, for the 3D view alone, so that with everything else there are about 30 frames a second.
  static constexpr double budget = 0.025;

  /// Something else is to be drawn, so long after the last time.
  void changed(double seconds) { hurried_ = seconds < 2 * whole_; }
  /// Drawing at `scale` took so long.
  void took(double scale, double seconds);
  /// Pixels drawn for each pixel seen, along an axis: 5/8, 3/4, 7/8 or 1. All of them, where there is
  /// time for that between changes.
  double scale() const { return hurried_ ? scale_ : 1; }

 private:
  double whole_ = 0;  ///< s, estimate of what all pixels take; 0: unknown
  double scale_ = 1;
  bool hurried_ = false;
};

}  // namespace collidoscope
