#pragma once
// A seeded source of 32-bit words for tests: std::mt19937, the same on every standard library.

#include <cstdint>
#include <random>

namespace collidoscope {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

}  // namespace collidoscope
