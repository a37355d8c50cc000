#include "viewer/view/view_scale.h"

#include <algorithm>
#include <cmath>

namespace collidoscope {

void ViewScale::took(double scale, double seconds) {
  const double whole = seconds / (scale * scale);
  whole_ = whole_ > 0 ? 0.75 * whole_ + 0.25 * whole : whole;
  const double wanted = std::sqrt(budget / std::max(whole_, 1e-9));
  // The scale changes only if another eighth is clearly better, to avoid flicker.
  if (std::abs(wanted - scale_) < 0.09) return;
  scale_ = std::clamp(std::floor(8 * wanted) / 8, 0.625, 1.0);
}

}  // namespace collidoscope
