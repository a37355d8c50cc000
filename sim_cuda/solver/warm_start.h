#pragma once
// Warm starting: what a solver keeps of the steps before, on the host and in double, so that another world
// can go on where one is. Plain data; bit-exact.

#include <array>
#include <cstdint>
#include <vector>

#include "sim_cuda/scene/joint.h"

namespace collidoscope {

/// A contact of a step and what it gave.
struct ContactImpulse {
  std::uint32_t a, b;  ///< ids, a < b
  double impulse;      ///< N s, along the normal, >= 0
};

/// A joint and what it gave in the last substep, as its kind has it (solver/joint_state.h).
struct WarmStartJoint {
  std::uint32_t a, b;
  std::uint64_t kind;             ///< a JointKind
  std::array<double, 7> impulse;  ///< N s, N m s
};

struct WarmStart {
  std::vector<ContactImpulse> contacts;    ///< by a, then b; of the last substep
  std::vector<std::vector<double>> walls;  ///< N s, by plane, then by body
  // What friction gave, N s; empty where there is none.
  std::vector<std::array<double, 3>> friction;       ///< as the contacts
  std::vector<std::array<double, 3>> wall_friction;  ///< plane by plane, all bodies of each
  // What rolling resistance gave, N m s; empty where there is none.
  std::vector<std::array<double, 3>> rolling, wall_rolling;  ///< as friction and wall_friction
  std::vector<std::uint32_t> sleep_timer;  ///< steps, by body (sleeping.h); empty without sleep
  std::vector<WarmStartJoint> joints;      ///< in the order of the scene
};

}  // namespace collidoscope
