#pragma once
// Jacobi's elliptic functions sn, cn, dn of the real argument u and the parameter m = k^2, and the complete
// integral K(m), by the arithmetic-geometric mean (Abramowitz & Stegun 16.4, 17.6): to a few units in the
// last place. They are what the large pendulum and the free body about its middle axis move by. Pure
// functions; for errors to be measured against, never for the state: they use libm.

namespace collidoscope {

struct JacobiElliptic {
  double sn, cn, dn;
};

/// 0 <= m < 1.
JacobiElliptic jacobi_elliptic(double u, double m);
/// K(m), a quarter of the period of sn and cn; 0 <= m < 1.
double complete_elliptic(double m);

}  // namespace collidoscope
