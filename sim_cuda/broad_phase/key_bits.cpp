#include "sim_cuda/broad_phase/key_bits.h"

#include <algorithm>
#include <vector>

namespace collidoscope {

int key_bits_called_for(const InitialBodies& bodies) {
  constexpr double packed = 0.64;  // of the space that spheres heaped up at random take, they fill
  constexpr double crowded = 128;  // bodies: SettleCells, morton_order.h
  if (static_cast<double>(bodies.size()) <= crowded) return 30;
  if (!bodies.box) return 63;
  // Half of the bodies are no smaller.
  std::vector<double> radii = bodies.radius;
  const auto median = radii.begin() + std::ssize(radii) / 2;
  std::ranges::nth_element(radii, median);
  constexpr double pi = 3.141592653589793;
  const double ball = 4 * pi / 3 * *median * *median * *median;
  const Vector3d sides = bodies.box->max - bodies.box->min;
  const double cell = sides.x() * sides.y() * sides.z() / static_cast<double>(bodies.size());
  return packed * cell > crowded * ball ? 63 : 30;
}

}  // namespace collidoscope
