#pragma once
// Residual of the velocity constraints after a solver iteration. Plain data.
//
// The residual of a contact is the change of relative speed, in m/s, that another solve of it would cause,
//
//   r = |delta| / m,   delta = proj(lambda - m (w + yield)) - lambda,
//
// with the impulse delta that the solver would add to lambda, and the effective mass m. proj projects onto
// the allowed impulses (no pull; friction within its cone). The residual is 0 exactly if the contact's
// complementarity problem is solved. Without softness r = |min(w, lambda / m)|, the natural residual of an
// LCP (Facchinei and Pang 2003; Erleben 2013, "Numerical Methods for Linear Complementarity Problems in
// Physics-Based Animation"). Normal and tangential parts are added as squares. Planes and boxes count as
// contacts; joints and rolling resistance do not.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

/// Statistics over active contacts after one iteration.
struct Residual {
  std::string stage;  ///< "solve" or "relax"
  int substep = 0;    ///< from 0
  int iteration = 0;  ///< from 1; 0: before the first iteration
  std::int64_t contacts = 0;
  double rms = 0, max = 0;  ///< m/s

  friend bool operator==(const Residual&, const Residual&) = default;
};

}  // namespace collidoscope
