#pragma once
// The effects that a simulation can include. An effect that is off costs no launch, no byte and no
// instruction: the stages that it touches take it as a template parameter, or it is a stage of its own.

namespace collidoscope {

/// One flag per effect. Which are on is physics: it decides the state.
struct Effects {
  bool gravity = false;    ///< a uniform acceleration; called for by gravity != 0
  bool attractor = false;  ///< points that pull; called for by a list of attractors
  bool drag = false;       ///< by what bodies move through; called for by a medium that is not nothing
  bool rotation =
      false;  ///< orientation and spin are stored and integrated; called for by anything that turns
  bool friction = false;  ///< Coulomb's, with rotation; called for by a material whose friction is not 0
  bool rolling_resistance = false;  ///< with friction; called for by a material of which it is not 0
  bool joints = false;              ///< called for by a list of joints: solver/joint_rows.h

  bool sleeping = false;  ///< islands at rest are not solved; called for by `sleep`

  friend bool operator==(const Effects&, const Effects&) = default;
};

}  // namespace collidoscope
