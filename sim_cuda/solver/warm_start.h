#pragma once
// Warm-start data of a solver on the host, in double. Bit-exact copies, used by snapshots and when a world
// is rebuilt after a change. Plain data.

#include <array>
#include <cstdint>
#include <vector>

#include "sim_cuda/core/deferred_parts.h"
#include "sim_cuda/scene/joint.h"

namespace collidoscope {

/// A contact and its accumulated impulse.
struct ContactImpulse {
  std::uint32_t a, b;  ///< ids, a < b
  double impulse;      ///< N s, along the normal, >= 0
};

/// A joint and its accumulated impulse of the last substep; layout of JointImpulse (joint_state.h).
struct WarmStartJoint {
  std::uint32_t a, b;
  std::uint64_t kind;             ///< JointKind
  std::array<double, 7> impulse;  ///< N s or N m s, by kind
};

struct WarmStart {
  std::vector<ContactImpulse> contacts;    ///< sorted by (a, b); impulses of the last substep
  std::vector<std::vector<double>> walls;  ///< N s, by surface, then by body
  // Friction impulses, N s; empty without friction.
  std::vector<std::array<double, 3>> friction;       ///< as `contacts`
  std::vector<std::array<double, 3>> wall_friction;  ///< index surface * body count + body
  // Rolling resistance impulses, N m s; empty without the effect.
  std::vector<std::array<double, 3>> rolling, wall_rolling;  ///< as `friction` and `wall_friction`
  std::vector<std::uint32_t> sleep_timer;  ///< steps, by body (sleeping.h); empty without the effect
  std::vector<WarmStartJoint> joints;      ///< in scene order
  std::vector<std::array<double, 2>> loop_energies;  ///< J, by group of joint loops; see LoopAllowance
};

/// Parts of a WarmStart whose arrays have been copied to the host, and are still to be widened.
using WarmStartParts = DeferredParts<WarmStart>;

}  // namespace collidoscope
