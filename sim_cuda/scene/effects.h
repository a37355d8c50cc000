#pragma once
// The effects of a simulation. A disabled effect launches no kernel and allocates no buffer.
// Stages shared by several effects test a flag or a null pointer that is the same for all items. In the
// contact iterations, precision and friction are template parameters.

namespace collidoscope {

/// One flag per effect. The flags are physical settings: they affect the state. The flag `guards` alone does
/// not.
struct Effects {
  bool gravity = false;    ///< uniform acceleration; required if gravity != 0
  bool attractor = false;  ///< attracting points; required if the scene lists attractors
  bool drag = false;       ///< drag of the medium; required if the medium is not vacuum
  bool rotation =
      false;  ///< orientation and spin are stored and integrated; required by spin, friction and joints
  bool friction = false;  ///< Coulomb friction, needs rotation; required if a material has friction > 0
  bool rolling_resistance = false;  ///< needs friction; required if a material has rolling_resistance > 0
  bool joints = false;              ///< solver/joint_constraint.h; required if the scene lists joints
  /// Prevents tunnelling: dynamics/continuous_collision.h. Required if a body starts so fast that it crosses
  /// the smallest radius in a substep.
  bool continuous_collision = false;

  bool sleeping = false;  ///< islands at rest are not solved; required if `sleep` is set
  bool guards = false;  ///< checks of the stage outputs: guard/stage_validator.h; required if `guards` is set

  friend bool operator==(const Effects&, const Effects&) = default;
};

/// Calls then<true>() if the effect is on, else then<false>(). Selects a template instance.
template <bool Effects::*effect, class Then>
void with_effect(const Effects& effects, const Then& then) {
  if (effects.*effect) return then.template operator()<true>();
  then.template operator()<false>();
}

}  // namespace collidoscope
