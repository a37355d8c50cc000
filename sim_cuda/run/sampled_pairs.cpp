#include "sim_cuda/run/sampled_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim_cuda/core/hash.h"
#include "sim_cuda/dynamics/bounds.h"

namespace collidoscope {
namespace {

constexpr std::size_t block = 1024;  // number of boxes per vectorized test

class Sample {
 public:
  Sample(const MovingSpheres& spheres, std::int64_t samples)
      : spheres_(spheres),
        count_(static_cast<std::int64_t>(spheres.position.size())),
        samples_(std::min(samples, count_)),
        found_(static_cast<std::size_t>(samples_)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis].resize(spheres.position.size());
      high_[axis].resize(spheres.position.size());
    }
    for (std::size_t i = 0; i < spheres.position.size(); ++i) find_box(i);
  }

  /// Counts pairs and contacts of one body of the sample.
  void test_sample(std::int64_t sample) {
    const std::size_t body = chosen(sample);
    Found& found = found_[static_cast<std::size_t>(sample)];
    std::array<std::uint8_t, block> hit;
    const auto all = static_cast<std::size_t>(count_);
    for (std::size_t from = 0; from < all; from += block) {
      const std::size_t to = std::min(from + block, all);
      if (test_boxes(body, from, to, hit) == 0) continue;
      for (std::size_t other = from; other < to; ++other) {
        if (hit[other - from] == 0 || other == body) continue;
        ++found.pairs;
        found.contacts += touch(body, other);
      }
    }
  }

  std::int64_t size() const { return samples_; }
  SampledPairs result() const {
    if (samples_ == 0) return {};
    SampledPairs sum;
    for (const Found& found : found_) {
      sum.pairs += static_cast<double>(found.pairs);
      sum.contacts += static_cast<double>(found.contacts);
    }
    const double each = static_cast<double>(count_) / (2 * static_cast<double>(samples_));
    return {each * sum.pairs, each * sum.contacts};
  }

 private:
  struct Found {
    std::int64_t pairs = 0, contacts = 0;
  };

  Vector3d velocity(std::size_t body) const {
    return spheres_.velocity.empty() ? Vector3d(0, 0, 0) : spheres_.velocity[body];
  }
  void find_box(std::size_t body) {
    const SpeculativeMargin<double>& margin = spheres_.margin;
    const Sweep<double> sweep{margin.bound == MotionBound::none ? 1 : 1 + nearly_touching, margin.time,
                              margin.acceleration_margin, margin.rebound, spheres_.moves_anywhere()};
    const Aabb box = sweep.box(spheres_.position[body], velocity(body), spheres_.radius[body]);
    for (int axis = 0; axis < 3; ++axis) {
      low_[static_cast<std::size_t>(axis)][body] = box.min[axis];
      high_[static_cast<std::size_t>(axis)][body] = box.max[axis];
    }
  }
  /// A pseudo-random body from each of `samples_` equal ranges of ids.
  std::size_t chosen(std::int64_t sample) const {
    const std::int64_t first = sample * count_ / samples_, last = (sample + 1) * count_ / samples_;
    const std::uint64_t offset =
        mix64(static_cast<std::uint64_t>(sample)) % static_cast<std::uint64_t>(last - first);
    return static_cast<std::size_t>(first) + offset;
  }
  /// Marks the boxes that overlap the body's box and returns their number. Branch-free, so that the
  /// compiler vectorizes it.
  int test_boxes(std::size_t body, std::size_t from, std::size_t to,
                 std::array<std::uint8_t, block>& hit) const {
    const float lx = low_[0][body], ly = low_[1][body], lz = low_[2][body];
    const float hx = high_[0][body], hy = high_[1][body], hz = high_[2][body];
    const float *lows[3] = {&low_[0][from], &low_[1][from], &low_[2][from]},
                *highs[3] = {&high_[0][from], &high_[1][from], &high_[2][from]};
    int hits = 0;
    for (std::size_t k = 0; k < to - from; ++k) {
      const bool overlap = (lows[0][k] <= hx) & (highs[0][k] >= lx) & (lows[1][k] <= hy) &
                           (highs[1][k] >= ly) & (lows[2][k] <= hz) & (highs[2][k] >= lz);
      hit[k] = static_cast<std::uint8_t>(overlap);
      hits += overlap;
    }
    return hits;
  }
  bool touch(std::size_t a, std::size_t b) const {
    if (spheres_.margin.bound == MotionBound::none)
      return spheres_touch<double>(spheres_.position[a], spheres_.radius[a], spheres_.position[b],
                                   spheres_.radius[b]);
    return spheres_will_touch<double>(spheres_.position[a], spheres_.radius[a], velocity(a),
                                      spheres_.position[b], spheres_.radius[b], velocity(b), spheres_.margin);
  }

  const MovingSpheres& spheres_;
  const std::int64_t count_, samples_;
  std::array<std::vector<float>, 3> low_, high_;
  std::vector<Found> found_;  // by sample
};

}  // namespace

SampledPairs sample_pairs(ThreadTeam& team, const MovingSpheres& spheres, std::int64_t samples) {
  Sample sample(spheres, samples);
  team.parallel_for(
      sample.size(), 1,
      [](void* context, std::int64_t begin, std::int64_t end) {
        for (std::int64_t k = begin; k < end; ++k) static_cast<Sample*>(context)->test_sample(k);
      },
      &sample);
  return sample.result();
}

}  // namespace collidoscope
