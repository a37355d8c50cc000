#pragma once
// The effect `continuous_collision`. Guarantee: two bodies that are apart at the start of a step have not
// passed through each other at its end, for any residual of the solver. The effect is required if a body
// starts so fast that it moves farther than the smallest radius in a substep.
//
// Two spheres pass through each other if their centres come nearer than half the sum of their radii: the
// *core* of the pair. Three measures keep the core free:
//
//  1. Boxes and contacts cover motion in any direction at the current speed (MotionBound::any_direction). Any
//     two bodies that may collide in the step have a contact.
//  2. Displacement limit: in a step, a body moves at most its speed times the step, plus the acceleration
//     margin, plus half its radius. Pairs without a contact, because another body hit one of them during the
//     step, therefore cannot reach each other's core.
//  3. Before each move, the displacements of contacts are clamped. If linear motion would enter the core,
//     both displacements are scaled by the same fraction, at which the spheres touch. A clamped body may
//     obstruct a third one. Clamping therefore repeats until a round clamps nothing, at most `rounds` times.
//
// A clamped body keeps its velocity: it loses time, but no momentum and no angular momentum. The potential
// energy of the way that it loses is added to StaticImpulse::push_work. (Compare Catto,
// "Continuous Collision", GDC 2013, which stops bodies at their time of impact with static bodies.) Kinematic
// bodies are never clamped. Planes and boxes stop bodies separately (solver/soft_walls.h).

#include <bit>
#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/core/pair.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/dynamics/body_state.h"

namespace collidoscope {

/// Fraction, 0 to 1, of the relative displacement `path` that does not enter the core. `d` is the position
/// relative to the other sphere, m; `reach` is the sum of the radii, m. Returns 1 if the path does not enter
/// the core, or if it starts within it. Returns 0 if the spheres overlap and approach.
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
  using std::sqrt;  // first root of |d + s path| = reach, in a form without cancellation
  return min_of(gap / (sqrt(max_of(along * along - length * gap, Real(0))) - along), Real(1));
}

template <class Real>
struct DisplacementLimit {
  Vector3<Real> start;  ///< m, position at the start of the step
  Real length;          ///< m
};

/// Input of a move: displacement limits and clamped fractions, by body.
template <class Real>
struct ClampedMotion {
  const DisplacementLimit<Real>* limit = nullptr;  ///< null: the effect is off
  const std::uint32_t* fraction = nullptr;   ///< bits of a float from 0 to 1; bits compare like the numbers
  StaticImpulse* static_impulses = nullptr;  ///< by body; null without gravity, attractors and planes
  const Vector3<Real>* field = nullptr;      ///< acceleration by attractors, m/s^2; null without them

  /// Acceleration by gravity and attractors, m/s^2.
  SIM_HD Vector3<Real> pull(int body, const Vector3<Real>& gravity) const {
    return field != nullptr ? Vector3<Real>(gravity + field[body]) : gravity;
  }
  /// Displacement in `h` s without contact clamping, m: along the velocity, up to the displacement limit.
  SIM_HD Vector3<Real> displacement(int body, const Vector3<Real>& x, const Vector3<Real>& v, Real h) const {
    const Vector3<Real> path = h * v, off = x - limit[body].start, end = off + path;
    const Real square = limit[body].length * limit[body].length;
    const Real all = path.dot(path);
    // A body at rest may lie slightly outside the limit (rounding, wall correction); leave it there.
    if (!(end.dot(end) > square) || !(all > 0)) return path;
    // Solve |off + s path| = length with `off` inside the limit, in a form without cancellation.
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

/// Owned by a solver. Allocates no memory if the effect is off, and must not be called then.
template <class Real>
class ContinuousCollision {
 public:
  /// Maximum number of clamping rounds (measure 3).
  static constexpr int rounds = 16;
  static_assert(rounds % 2 == 0, "the last round must write the fractions that motion() reads");

  explicit ContinuousCollision(Executor& executor);
  void enable(const BodyView<Real>& bodies, std::int64_t body_count, const StepControl* control);

  /// Call at the start of a step of `time` s. `acceleration_margin`, m, as in SpeculativeMargin.
  void begin(Real time, Real acceleration_margin);
  /// Call before a move of `h` s along the velocities of `moving`. `contacts`: the contacts of the step, at
  /// most `capacity`.
  void clamp_motion(const BodyView<Real>& moving, const Pair* contacts, std::int64_t capacity, Real h);
  ClampedMotion<Real> motion() const { return {displacement_limit_.data(), fraction_.data()}; }

 private:
  Executor& executor_;
  BodyView<Real> bodies_{};
  std::int64_t body_count_ = 0;
  const StepControl* control_ = nullptr;
  Buffer<DisplacementLimit<Real>> displacement_limit_;  // by body
  Buffer<std::uint32_t> fraction_;                      // two per body
  Buffer<std::uint32_t> entered_;                       // by round: 1 if a displacement was clamped
};

}  // namespace collidoscope
