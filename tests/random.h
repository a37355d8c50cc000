#pragma once
// A seeded source of 32-bit words for tests: std::mt19937, equal on every standard library.

#include <cstdint>
#include <random>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

/// Uniformly distributed numbers and vectors.
struct Uniform {
  Random random;
  double operator()(double low, double high) { return low + (high - low) * (random() / 4294967296.0); }
  Vector3d vector(double size) {
    return Vector3d((*this)(-size, size), (*this)(-size, size), (*this)(-size, size));
  }
};

}  // namespace collidoscope
