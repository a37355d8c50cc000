#include "sim_cuda/run/frozen.h"

#include <algorithm>

#include "sim_cuda/guard/stage_guard.h"

namespace collidoscope {
namespace {

bool is_placed(const BodyStates& bodies, std::uint32_t body, const Guards& guards) {
  const SaneLimits<double> limits(guards);
  return limits.within(bodies.position[body], limits.distance) && limits.unit(bodies.orientation[body]);
}

}  // namespace

bool is_sane(const BodyStates& bodies, std::uint32_t body, const Guards& guards) {
  const SaneLimits<double> limits(guards);
  return is_placed(bodies, body, guards) && limits.within(bodies.velocity[body], limits.speed) &&
         limits.within(bodies.angular_velocity[body], limits.spin);
}

void freeze(RunState& state, std::uint32_t body, const InitialBodies& initial, const Guards& guards) {
  state.frozen.insert(std::ranges::upper_bound(state.frozen, body), body);
  if (is_placed(state.bodies, body, guards)) return;
  state.bodies.position[body] = initial.position[body];
  state.bodies.orientation[body] =
      initial.orientation.empty() ? Quaterniond(1, 0, 0, 0) : initial.orientation[body];
}

InitialBodies with_frozen(InitialBodies initial, const std::vector<std::uint32_t>& frozen) {
  if (!frozen.empty()) initial.motion.resize(initial.size(), Motion::dynamic);
  for (const std::uint32_t body : frozen) initial.motion[body] = Motion::fixed;
  return initial;
}

}  // namespace collidoscope
