#pragma once
// Planes of floats and separable filters, for flip.cpp.

#include <cstddef>
#include <vector>

// Functions that are also compiled for AVX2, and chosen at the start of the program. Without fused
// multiply-add, so that both give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(WITH_SANITIZER)
#define VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define VECTORISED
#endif

namespace collidoscope::capture {

class Plane {
 public:
  Plane() = default;
  Plane(int width, int height)
      : width_(width),
        height_(height),
        values_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}
  int width() const { return width_; }
  int height() const { return height_; }
  float* row(int y) {
    return values_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }
  const float* row(int y) const {
    return values_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }

 private:
  int width_ = 0, height_ = 0;
  std::vector<float> values_;
};

enum class Parity { even, odd };

/// Applies a kernel along x, given from its middle on. The result has `margin` fewer columns on each side;
/// the kernel has at most margin + 1 values.
Plane filtered_across(const Plane& plane, const std::vector<float>& kernel, Parity parity, int margin);
/// The same along y.
Plane filtered_down(const Plane& plane, const std::vector<float>& kernel, Parity parity, int margin);
/// to = share_of_to * to + share * from
void mix(const Plane& from, float share, float share_of_to, Plane& to);
/// to = scale * sqrt(to^2 + other^2)
void length_of(const Plane& other, float scale, Plane& to);

}  // namespace collidoscope::capture
