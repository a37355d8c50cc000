#pragma once
// The effects that a simulation can include. An effect that is off has no launch and no buffer. Stages of its
// own are not launched; stages that it shares with other effects test a flag or a null pointer, which is the
// same for all items. Precision and friction in the contact sweeps are template parameters.

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
  bool guards = false;    ///< who looks at what stages write: guard/stage_validator.h; called for by `guards`

  friend bool operator==(const Effects&, const Effects&) = default;
};

/// Calls then<true>() where the effect is on, else then<false>(): a template for each.
template <bool Effects::*effect, class Then>
void with_effect(const Effects& effects, const Then& then) {
  if (effects.*effect) return then.template operator()<true>();
  then.template operator()<false>();
}

}  // namespace collidoscope
