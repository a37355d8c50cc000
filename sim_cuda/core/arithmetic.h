#pragma once
// Arithmetic that gives the same results on CPU and GPU. All functions define the results for NaN and
// overflow, which std::min, fmin and plain casts leave open.

#include <bit>
#include <cstdint>
#include <limits>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// Minimum. Returns `a` if both are equal or `b` is NaN.
template <class T>
SIM_HD constexpr T min_of(T a, T b) {
  return b < a ? b : a;
}

/// Maximum. Returns `a` if both are equal or `b` is NaN.
template <class T>
SIM_HD constexpr T max_of(T a, T b) {
  return a < b ? b : a;
}

/// `x` clamped to [low, high]; `low` if x is NaN.
template <class T>
SIM_HD constexpr T clamp_to(T x, T low, T high) {
  return x > low ? (x < high ? x : high) : low;
}

/// Index of the cell of width 1 that contains x, clamped to 0 .. cells-1; 0 for NaN. Clamps before the
/// conversion, which therefore cannot overflow. Precondition: `cells` is exact in Real.
template <class Real>
SIM_HD constexpr std::uint32_t to_cell(Real x, std::uint32_t cells) {
  return static_cast<std::uint32_t>(clamp_to(x, Real(0), static_cast<Real>(cells - 1)));
}

/// Whether x is neither infinite nor NaN. A bit test, so that fast-math flags do not change the result.
SIM_HD constexpr bool finite(float x) {
  return (std::bit_cast<std::uint32_t>(x) & 0x7f800000u) != 0x7f800000u;
}
SIM_HD constexpr bool finite(double x) {
  return (std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000u) != 0x7ff0000000000000u;
}

/// The next float below or above x. Infinities and NaN are returned unchanged.
SIM_HD constexpr float next_down(float x) {
  if (!finite(x)) return x;
  const auto bits = std::bit_cast<std::uint32_t>(x);
  if ((bits & 0x7fffffffu) == 0) return std::bit_cast<float>(0x80000001u);
  return std::bit_cast<float>((bits & 0x80000000u) ? bits + 1 : bits - 1);
}
SIM_HD constexpr float next_up(float x) { return -next_down(-x); }

/// The largest float <= x, and the smallest float >= x. Double runs use them to round boxes outward.
SIM_HD constexpr float round_down(float x) { return x; }
SIM_HD constexpr float round_up(float x) { return x; }
SIM_HD constexpr float round_down(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) > x ? next_down(f) : f;
}
SIM_HD constexpr float round_up(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) < x ? next_up(f) : f;
}

SIM_HD inline std::uint32_t count_bits(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return static_cast<std::uint32_t>(__popc(bits));
#else
  // Not std::popcount(), which is a call of a library function if the processor may lack the instruction.
  bits -= bits >> 1 & 0x55555555u;
  bits = (bits & 0x33333333u) + (bits >> 2 & 0x33333333u);
  return ((bits + (bits >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24;
#endif
}

}  // namespace collidoscope
