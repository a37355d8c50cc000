#pragma once
// The effect `continuous_collision`: no two bodies that are apart when a step begins have passed through each
// other when it ends, whatever the sweeps of the solver have left unsolved. Called for where a body starts so
// fast that it goes farther than the smallest radius in a substep.
//
// Two spheres pass through each other where their centres come nearer than half the sum of their radii: the
// *core* of the pair. It stays free by three measures:
//
//   1. Boxes and contacts cover any direction at the speed that a body has (MotionBound::any_direction):
//   whoever may meet in
//      the step is a contact.
//   2. The displacement limit: no body moves farther in a step than that, and half its radius. So those whose
//   contact was
//      not predicted, since something hit them in the step, keep clear of their core.
//   3. Before each move, of all contacts: straight ways that would enter the core are cut short, both by the
//      same share, at the place where the two touch. Who is cut short may now stand in the way of a third, so
//      it goes in rounds, until a round finds nothing, or there were `rounds` of them.
//
// A clamped body keeps its velocity and goes along it, so it loses time, not momentum, and no angular
// momentum (Catto, "Continuous Collision", GDC 2013, which holds bodies at their time of impact with what
// does not move). Bodies whose motion is prescribed go where they go. Walls, planes and boxes, stop bodies by
// themselves (solver/soft_walls.h).

#include <bit>
#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/pair.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"

namespace collidoscope {

/// How much of its way, 0 to 1, a sphere may go that is at `d` from another, m, and would go `path` further
/// relative to it, so that the way does not enter the core; `reach` is the sum of their radii, m. 1 where it
/// does not, or where the centres lie in the core already; 0 where they overlap and would go on.
template <class Real>
SIM_HD Real fraction_outside_core(const Vector3<Real>& d, const Vector3<Real>& path, Real reach) {
  const Real along = d.dot(path);
  if (!(along < 0)) return 1;
  const Real length = path.dot(path), distance = d.dot(d), core = reach * reach / 4;
  if (!(distance > core)) return 1;
  const Real nearest = along + length > 0 ? distance - along * along / length : distance + 2 * along + length;
  if (nearest >= core) return 1;
  const Real gap = distance - reach * reach;
  if (!(gap > 0)) return 0;
  using std::sqrt;  // the first root of |d + s way| = reach, in the form that does not cancel
  return min_of(gap / (sqrt(max_of(along * along - length * gap, Real(0))) - along), Real(1));
}

template <class Real>
struct DisplacementLimit {
  Vector3<Real> start;  ///< m, where the body was when the step began
  Real length;          ///< m
};

/// What a move must know of it.
template <class Real>
struct ClampedMotion {
  const DisplacementLimit<Real>* limit = nullptr;  ///< null: the effect is off
  const std::uint32_t* fraction =
      nullptr;  ///< bits of a float from 0 to 1, which are in the order of the numbers

  /// m: what the body goes in `h` s unless a contact clamps it: along its velocity, up to the displacement
  /// limit.
  SIM_HD Vector3<Real> displacement(int body, const Vector3<Real>& x, const Vector3<Real>& v, Real h) const {
    const Vector3<Real> path = h * v, off = x - limit[body].start, end = off + path;
    const Real square = limit[body].length * limit[body].length;
    const Real all = path.dot(path);
    // Who stands still may be off by a rounding, or because a wall has pushed him there: he stays.
    if (!(end.dot(end) > square) || !(all > 0)) return path;
    // |off + s way| = length, where off lies within it; in the form that does not cancel.
    const Real along = off.dot(path), left = max_of(square - off.dot(off), Real(0));
    using std::sqrt;
    const Real root = sqrt(along * along + all * left);
    const Real s = along > 0 ? left / (along + root) : (root - along) / all;
    return min_of(s, Real(1)) * path;
  }
  SIM_HD Vector3<Real> clamped_displacement(int body, const Vector3<Real>& x, const Vector3<Real>& v,
                                            Real h) const {
    return static_cast<Real>(std::bit_cast<float>(fraction[body])) * displacement(body, x, v, h);
  }
};

/// Lives as long as its solver. Takes no memory, and must not be called, where the effect is off.
template <class Real>
class ContinuousCollision {
 public:
  /// Rounds of measure 3 at most.
  static constexpr int rounds = 16;
  static_assert(rounds % 2 == 0, "the last of them writes the shares that motion() reads");

  explicit ContinuousCollision(Executor& executor);
  void enable(const BodyView<Real>& bodies, std::int64_t body_count, const StepControl* control);

  /// At the start of a step of `time` s, in which bodies go aside by at most `acceleration_margin` m, as in
  /// SpeculativeMargin.
  void begin(Real time, Real acceleration_margin);
  /// Before a move of `h` s along the velocities of `moving`; `contacts` are those of the step, at most
  /// `capacity`.
  void clamp_motion(const BodyView<Real>& moving, const Pair* contacts, std::int64_t capacity, Real h);
  ClampedMotion<Real> motion() const { return {displacement_limit_.data(), fraction_.data()}; }

 private:
  Executor& executor_;
  BodyView<Real> bodies_{};
  std::int64_t body_count_ = 0;
  const StepControl* control_ = nullptr;
  Buffer<DisplacementLimit<Real>> displacement_limit_;  // by body
  Buffer<std::uint32_t> fraction_;                      // two of each body
  Buffer<std::uint32_t> entered_;                       // by round: 1 where something would enter a core
};

}  // namespace collidoscope
