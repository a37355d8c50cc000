#pragma once
// How well a solver's sweeps have solved their contacts: the residual of the velocity constraints. Plain
// data.
//
// A contact's residual is the speed, in m/s, by which it would change the motion of its two bodies against
// each other if it were solved once more,
//
//   r = |delta| / m,   delta = proj(lambda - m (w + yield)) - lambda,
//
// delta the impulse that the solver would add to lambda, m the mass that it works against, proj onto what a
// contact may give (no pull; friction within its cone). It is 0 exactly where the contact's complementarity
// problem is solved: without softness r = |min(w, lambda / m)|, the natural residual of an LCP (Facchinei and
// Pang 2003; Erleben 2013, "Numerical Methods for Linear Complementarity Problems in Physics-Based
// Animation"). The parts along and across the normal are added as squares. Planes and boxes count as
// contacts; joints and rolling resistance are not looked at.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

/// Over the contacts that press or would begin to, after one sweep over all of them.
struct Residual {
  std::string stage;  ///< "solve" or "relax", as the stage that made the iteration
  int substep = 0;    ///< from 0
  int iteration = 0;  ///< from 1; 0: before the first, from what the substep before left
  std::int64_t contacts = 0;
  double rms = 0, max = 0;  ///< m/s

  friend bool operator==(const Residual&, const Residual&) = default;
};

}  // namespace collidoscope
