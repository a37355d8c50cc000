#pragma once
// Exponential, sine and cosine by series of + - x / only, for constants that affect the state: libm results
// differ by version. Usable on the host and at compile time. Double, accurate to about 13 digits.

namespace collidoscope {

/// e^x - 1 for x <= 0; -1 below -700. Accurate near 0.
constexpr double expm1_series(double x) {
  if (!(x > -700)) return -1;
  int halvings = 0;
  for (; x < -0.5; x /= 2) ++halvings;
  double term = 1, sum = 0;
  for (int k = 1; k <= 18; ++k) {
    term *= x / k;
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = sum * (sum + 2);  // (1 + s)^2 - 1
  return sum;
}

struct CosineSine {
  double cosine, sine;
};

/// Cosine and sine of an angle in radians, with |x| <= 2.
constexpr CosineSine cosine_sine(double x) {
  double even = 1, odd = x, cosine = 0, sine = 0;
  for (int k = 1; k <= 25; k += 2) {
    cosine += even;
    sine += odd;
    even *= -x * x / (k * (k + 1));
    odd *= -x * x / ((k + 1) * (k + 2));
  }
  return {cosine, sine};
}

}  // namespace collidoscope
