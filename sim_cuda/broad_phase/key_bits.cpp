#include "sim_cuda/broad_phase/key_bits.h"

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "sim_cuda/broad_phase/counting_cells.h"
#include "sim_cuda/broad_phase/morton.h"

namespace collidoscope {
namespace {

/// Whether a pile of the scene's smaller bodies would overfill cells of a counting sort: on average over all
/// bodies, a cell has more other bodies than half of large_cell_size.
bool pile_exceeds_cells(const InitialBodies& bodies, const Box& box) {
  constexpr double packed = 0.64;  // volume fraction of random close packing of spheres
  std::vector<double> radii = bodies.radius;
  std::ranges::sort(radii);
  const auto n = static_cast<double>(bodies.size());
  const Vector3d sides = box.max - box.min;
  const double space = packed * sides.x() * sides.y() * sides.z() / n;
  // Tests the smallest 10 %, 20 % ... 50 % of the bodies. Fewer bodies are not expected to form a pile by
  // themselves.
  for (int tenths = 1; tenths <= 5; ++tenths) {
    const double share = tenths / 10.0, r = radii[static_cast<std::size_t>(share * (n - 1))];
    const double ball = 4 * std::numbers::pi / 3 * r * r * r;
    const double heap = std::min(share * n, space / ball);
    if (share * heap > large_cell_size / 2.0) return true;
  }
  return false;
}

/// Occupancy of the cells given by the leading bits of the keys.
struct CellOccupancy {
  double mean_others = 0;  ///< other bodies in a body's cell, mean over bodies
  double max_bodies = 0;   ///< bodies in the fullest cell
};

/// The 63-bit keys of every k-th body, sorted. Includes all bodies if there are few.
class KeySample {
 public:
  KeySample(const std::vector<Vector3d>& position, const Box& box) : bodies_(position.size()) {
    const Aabb extent{box.min.cast<float>(), box.max.cast<float>()};
    const std::size_t stride = bodies_ / max_samples + 1;
    for (std::size_t k = 0; k < bodies_; k += stride) {
      const Vector3f center = position[k].cast<float>();
      keys_.push_back(morton_key<std::uint64_t>({center, center}, extent));
    }
    std::ranges::sort(keys_);
  }

  CellOccupancy in_cells(int bits) const {
    const int shift = 63 - bits;
    double pairs = 0;
    std::size_t fullest = 0;
    for (std::size_t first = 0, end = 0; first < keys_.size(); first = end) {
      while (end < keys_.size() && keys_[end] >> shift == keys_[first] >> shift) ++end;
      pairs += static_cast<double>(end - first) * static_cast<double>(end - first - 1);
      fullest = std::max(fullest, end - first);
    }
    const auto n = static_cast<double>(bodies_), sampled = static_cast<double>(keys_.size());
    return {(n - 1) * pairs / (sampled * std::max(sampled - 1, 1.0)),
            static_cast<double>(fullest) * n / sampled};
  }

 private:
  static constexpr std::size_t max_samples = 1 << 16;
  std::size_t bodies_;
  std::vector<std::uint64_t> keys_;
};

}  // namespace

int automatic_key_bits(const InitialBodies& bodies, const std::vector<Vector3d>& position, SortMethod sort) {
  const auto n = static_cast<std::int64_t>(bodies.size());
  const bool counting = sorts_by_counting(sort, n);
  const int shortest = counting || n > 1 << 24 ? 30 : 24;
  if (n <= large_cell_size) return shortest;
  if (!bodies.box || pile_exceeds_cells(bodies, *bodies.box)) return 63;
  const KeySample keys(position, *bodies.box);
  if (counting) {
    // Beyond this size, a block that sorts one cell takes longer than the library takes for all keys.
    constexpr double largest_cell = 1024;
    const CellOccupancy cells = keys.in_cells(counting_cell_bits(n));
    if (cells.mean_others > large_cell_size || cells.max_bodies > largest_cell) return 63;
  }
  constexpr double acceptable = 8;  // additional visits per query; a query of a good tree has about 20
  for (const int bits : {24, 30})
    if (bits >= shortest && keys.in_cells(bits).mean_others <= acceptable) return bits;
  return 63;
}

}  // namespace collidoscope
