#pragma once
// The effect `continuous_collision`: no two bodies that are apart when a step begins have passed through each
// other when it ends, whatever the sweeps of the solver have left unsolved. Called for where a body starts so
// fast that it goes farther than the smallest radius in a substep.
//
// Two spheres pass through each other where their centres come nearer than half the sum of their radii: the
// *core* of the pair. It stays free by three measures:
//
//   1. Boxes and contacts foresee any course at the speed that a body has (Course::any): whoever may meet in
//      the step is a contact.
//   2. The leash: nobody goes farther in a step than that, and half its radius. So those whose meeting was
//      not foreseen, since something hit them in the step, keep clear of their core.
//   3. Before each move, of all contacts: straight ways that would enter the core are cut short, both by the
//      same share, at the place where the two touch. Who is cut short may now stand in the way of a third, so
//      it goes in rounds, until a round finds nothing, or there were `rounds` of them.
//
// What is held back keeps its velocity and goes along it, so it loses time, not momentum, and no angular
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

/// How much of its way, 0 to 1, a sphere may go that is at `d` from another, m, and would go `way` further
/// relative to it, so that the way does not enter the core; `reach` is the sum of their radii, m. 1 where it
/// does not, or where the centres lie in the core already; 0 where they overlap and would go on.
template <class Real>
SIM_HD Real share_outside_core(const Vector3<Real>& d, const Vector3<Real>& way, Real reach) {
  const Real along = d.dot(way);
  if (!(along < 0)) return 1;
  const Real length = way.dot(way), distance = d.dot(d), core = reach * reach / 4;
  if (!(distance > core)) return 1;
  const Real nearest = along + length > 0 ? distance - along * along / length : distance + 2 * along + length;
  if (nearest >= core) return 1;
  const Real gap = distance - reach * reach;
  if (!(gap > 0)) return 0;
  using std::sqrt;  // the first root of |d + s way| = reach, in the form that does not cancel
  return min_of(gap / (sqrt(max_of(along * along - length * gap, Real(0))) - along), Real(1));
}

template <class Real>
struct Leash {
  Vector3<Real> start;  ///< m, where the body was when the step began
  Real length;          ///< m
};

/// What a move must know of it.
template <class Real>
struct HeldMotion {
  const Leash<Real>* leash = nullptr;  ///< null: the effect is off
  const std::uint32_t* share =
      nullptr;  ///< bits of a float from 0 to 1, which are in the order of the numbers

  /// m: what the body goes in `h` s unless a contact holds it: along its velocity, to the end of the leash.
  SIM_HD Vector3<Real> way(int body, const Vector3<Real>& x, const Vector3<Real>& v, Real h) const {
    const Vector3<Real> way = h * v, off = x - leash[body].start, end = off + way;
    const Real square = leash[body].length * leash[body].length;
    const Real all = way.dot(way);
    // Who stands still may be off by a rounding, or because a wall has pushed him there: he stays.
    if (!(end.dot(end) > square) || !(all > 0)) return way;
    // |off + s way| = length, where off lies within it; in the form that does not cancel.
    const Real along = off.dot(way), left = max_of(square - off.dot(off), Real(0));
    using std::sqrt;
    const Real root = sqrt(along * along + all * left);
    const Real s = along > 0 ? left / (along + root) : (root - along) / all;
    return min_of(s, Real(1)) * way;
  }
  SIM_HD Vector3<Real> held_way(int body, const Vector3<Real>& x, const Vector3<Real>& v, Real h) const {
    return static_cast<Real>(std::bit_cast<float>(share[body])) * way(body, x, v, h);
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

  /// At the start of a step of `time` s, in which bodies go aside by at most `slack` m: foresight's.
  void begin(Real time, Real slack);
  /// Before a move of `h` s along the velocities of `ways`; `contacts` are those of the step, at most
  /// `capacity`.
  void hold(const BodyView<Real>& ways, const Pair* contacts, std::int64_t capacity, Real h);
  HeldMotion<Real> motion() const { return {leash_.data(), share_.data()}; }

 private:
  Executor& executor_;
  BodyView<Real> bodies_{};
  std::int64_t body_count_ = 0;
  const StepControl* control_ = nullptr;
  Buffer<Leash<Real>> leash_;      // by body
  Buffer<std::uint32_t> share_;    // two of each body
  Buffer<std::uint32_t> entered_;  // by round: 1 where something would enter a core
};

}  // namespace collidoscope
