#pragma once
// Jacobi's elliptic functions sn, cn, dn of the real argument u and the parameter m = k^2, and the complete
// integral K(m). Used for the large pendulum and for free rotation near the middle axis.
// Computed by the arithmetic-geometric mean (Abramowitz & Stegun 16.4, 17.6), accurate to a few units in the
// last place.
// Pure functions. They use libm, so use them for reference solutions only and never for the state.

namespace collidoscope {

struct JacobiElliptic {
  double sn, cn, dn;
};

/// Requires 0 <= m < 1.
JacobiElliptic jacobi_elliptic(double u, double m);
/// K(m), a quarter of the period of sn and cn. Requires 0 <= m < 1.
double complete_elliptic(double m);

}  // namespace collidoscope
