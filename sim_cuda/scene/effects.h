#pragma once
// The effects that a simulation can include. An effect that is off costs no launch, no byte and no
// instruction: the stages that it touches take it as a template parameter, or it is a stage of its own. A
// build may also leave some out altogether, which is how `bench effects` proves it.

#include <string_view>

// The names of effects that this build leaves out, with a space between.
#ifndef SIM_WITHOUT
#define SIM_WITHOUT ""
#endif

namespace collidoscope {

/// One flag per effect. Which are on is physics: it decides the state (guards alone do not).
struct Effects {
  bool gravity = false;    ///< a uniform acceleration; called for by gravity != 0
  bool attractor = false;  ///< points that pull; called for by a list of attractors
  bool drag = false;       ///< by what bodies move through; called for by a medium that is not nothing
  bool rotation =
      false;  ///< orientation and spin are stored and integrated; called for by anything that turns
  bool friction = false;  ///< Coulomb's, with rotation; called for by a material whose friction is not 0
  bool rolling_resistance = false;  ///< with friction; called for by a material of which it is not 0
  bool joints = false;              ///< called for by a list of joints: solver/joint_rows.h
  /// Nothing passes through anything; called for by a starting speed that crosses the smallest radius in a
  /// substep: dynamics/continuous_collision.h
  bool continuous_collision = false;

  bool sleeping = false;  ///< islands at rest are not solved; called for by `sleep`
  bool guards = false;    ///< who looks at what stages write: guard/stage_guard.h; called for by `guards`

  friend bool operator==(const Effects&, const Effects&) = default;
};

constexpr bool is_built(std::string_view effect, std::string_view without = SIM_WITHOUT) {
  while (!without.empty()) {
    const std::size_t end = without.find(' ');
    if (without.substr(0, end) == effect) return false;
    without.remove_prefix(end == without.npos ? without.size() : end + 1);
  }
  return true;
}

/// What this build can include.
inline constexpr Effects built_effects{.gravity = is_built("gravity"),
                                       .attractor = is_built("attractor"),
                                       .drag = is_built("drag"),
                                       .rotation = is_built("rotation"),
                                       .friction = is_built("friction"),
                                       .rolling_resistance = is_built("rolling_resistance"),
                                       .joints = is_built("joints"),
                                       .continuous_collision = is_built("continuous_collision"),
                                       .sleeping = is_built("sleeping"),
                                       .guards = is_built("guards")};

/// Calls then<true>() where the effect is on, else then<false>(): a template for each. What is left out of
/// the build is not compiled.
template <bool Effects::*effect, class Then>
void with_effect(const Effects& effects, const Then& then) {
  if constexpr (built_effects.*effect)
    if (effects.*effect) return then.template operator()<true>();
  then.template operator()<false>();
}

}  // namespace collidoscope
