#pragma once
// Sine and cosine in double with + - * and comparisons only: the same bits on every CPU and GPU.
//
// Argument reduction (Cody, Waite 1980): x - n pi/2 with n the integer nearest to 2 x / pi. pi/2 is split
// into three parts of 33, 33 and 53 bits. For |x| < 1.6e6 (|n| < 2^20) the products of n with the first two
// parts are exact, and both results have an error below one unit in the last place. Beyond, the error of the
// angle is of the order of the rounding of x itself, 2^-53 |x|. From 2^50 on, the last place of x is a large
// part of a radian, and the angle counts as 0. Infinities and NaN give NaN.
//
// Splitting of pi/2 and polynomials: fdlibm 5.3, e_rem_pio2.c, k_sin.c and k_cos.c, with this notice:
//   Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
//   Developed at SunPro, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and distribute
//   this software is freely granted, provided that this notice is preserved.

#include <cstdint>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

struct SineCosine {
  double sine, cosine;
};

namespace detail {

/// For |x| up to pi/4, with a small margin. `rest`: rounding error of x.
SIM_HD inline double sine_near_0(double x, double rest) {
  constexpr double s1 = -1.66666666666666324348e-01, s2 = 8.33333333332248946124e-03,
                   s3 = -1.98412698298579493134e-04, s4 = 2.75573137070700676789e-06,
                   s5 = -2.50507602534068634195e-08, s6 = 1.58969099521155010221e-10;
  const double z = x * x, cube = z * x;
  const double r = s2 + z * (s3 + z * (s4 + z * (s5 + z * s6)));
  return x - ((z * (rest / 2 - cube * r) - rest) - cube * s1);
}

SIM_HD inline double cosine_near_0(double x, double rest) {
  constexpr double c1 = 4.16666666666666019037e-02, c2 = -1.38888888888741095749e-03,
                   c3 = 2.48015872894767294178e-05, c4 = -2.75573143513906633035e-07,
                   c5 = 2.08757232129817482790e-09, c6 = -1.13596475577881948265e-11;
  const double z = x * x;
  const double r = z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6)))));
  const double half = z / 2, first = 1 - half;
  return first + (((1 - first) - half) + (z * r - x * rest));
}

}  // namespace detail

/// `x` in rad.
SIM_HD inline SineCosine sine_and_cosine(double x) {
  constexpr double limit = 0x1p50;
  if (!(x > -limit && x < limit)) {
    const double zero = x - x;  // NaN if x is not finite
    return {zero, 1 + zero};
  }
  constexpr double two_over_pi = 6.36619772367581382433e-01;
  constexpr double part1 = 1.57079632673412561417e+00, part2 = 6.07710050630396597660e-11,
                   part3 = 2.02226624879595063154e-21;
  constexpr double rounder = 0x1.8p52;  // adding it rounds to an integer
  const double n = (x * two_over_pi + rounder) - rounder;
  const double coarse = x - n * part1, product = n * part2;
  const double fine = coarse - product;
  const double left = n * part3 - ((coarse - fine) - product);
  const double r = fine - left, rest = (fine - r) - left;
  const double sine = detail::sine_near_0(r, rest), cosine = detail::cosine_near_0(r, rest);
  switch (static_cast<std::int64_t>(n) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

}  // namespace collidoscope
