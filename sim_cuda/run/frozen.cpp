#include "sim_cuda/run/frozen.h"

#include <algorithm>

#include "sim_cuda/guard/stage_validator.h"

namespace collidoscope {
namespace {

bool has_valid_pose(const BodyStates& bodies, std::uint32_t body, const ValidationSettings& guards) {
  const ValidationLimits<double> limits(guards);
  return limits.within(bodies.position[body], limits.distance) && limits.unit(bodies.orientation[body]);
}

}  // namespace

bool is_valid_state(const BodyStates& bodies, std::uint32_t body, const ValidationSettings& guards) {
  const ValidationLimits<double> limits(guards);
  return has_valid_pose(bodies, body, guards) && limits.within(bodies.velocity[body], limits.speed) &&
         limits.within(bodies.angular_velocity[body], limits.angular_speed);
}

void freeze(RunState& state, std::uint32_t body, const InitialBodies& initial,
            const ValidationSettings& guards) {
  state.frozen.insert(std::ranges::upper_bound(state.frozen, body), body);
  if (has_valid_pose(state.bodies, body, guards)) return;
  state.bodies.position[body] = initial.position[body];
  state.bodies.orientation[body] =
      initial.orientation.empty() ? Quaterniond(1, 0, 0, 0) : initial.orientation[body];
}

InitialBodies with_static_bodies(InitialBodies initial, const std::vector<std::uint32_t>& frozen) {
  if (!frozen.empty()) initial.motion.resize(initial.size(), Motion::dynamic);
  for (const std::uint32_t body : frozen) initial.motion[body] = Motion::fixed;
  return initial;
}

}  // namespace collidoscope
