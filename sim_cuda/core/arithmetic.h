#pragma once
// Arithmetic with every case defined, the same on CPU and GPU: what std::min, fmin and a plain cast leave
// open (NaN, overflow) is fixed here.

#include <bit>
#include <cstdint>
#include <limits>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

/// The smaller; `a` where they are equal or `b` is NaN.
template <class T>
SIM_HD constexpr T min_of(T a, T b) {
  return b < a ? b : a;
}

/// The larger; `a` where they are equal or `b` is NaN.
template <class T>
SIM_HD constexpr T max_of(T a, T b) {
  return a < b ? b : a;
}

/// `x` moved into [low, high]; `low` where x is NaN.
template <class T>
SIM_HD constexpr T clamp_to(T x, T low, T high) {
  return x > low ? (x < high ? x : high) : low;
}

/// The cell in 0 .. cells-1 that holds x, cells being numbered from 0 with width 1; 0 for NaN. Clamps first,
/// so that no conversion overflows. `cells` must be exact in Real.
template <class Real>
SIM_HD constexpr std::uint32_t to_cell(Real x, std::uint32_t cells) {
  return static_cast<std::uint32_t>(clamp_to(x, Real(0), static_cast<Real>(cells - 1)));
}

/// Whether x is neither infinite nor NaN, whatever fast-math flags a user adds.
SIM_HD constexpr bool finite(float x) {
  return (std::bit_cast<std::uint32_t>(x) & 0x7f800000u) != 0x7f800000u;
}
SIM_HD constexpr bool finite(double x) {
  return (std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000u) != 0x7ff0000000000000u;
}

/// The neighbouring float below / above; infinities and NaN stay.
SIM_HD constexpr float next_down(float x) {
  if (!finite(x)) return x;
  const auto bits = std::bit_cast<std::uint32_t>(x);
  if ((bits & 0x7fffffffu) == 0) return std::bit_cast<float>(0x80000001u);
  return std::bit_cast<float>((bits & 0x80000000u) ? bits + 1 : bits - 1);
}
SIM_HD constexpr float next_up(float x) { return -next_down(-x); }

/// The largest float <= x, and the smallest >= x: boxes of double runs are rounded outward.
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
  return static_cast<std::uint32_t>(std::popcount(bits));
#endif
}

}  // namespace collidoscope
