#pragma once
// How many substeps the joints of a scene call for.

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// K as set, or what "auto" comes to: substeps_in_effect(); with joints more, up to 64, so many that each of
/// them that is coupled yields at rest by at most 1 % of the distance that it spans, though it carry the
/// weight F of all that hangs together with it: F h^2 n / (4 m) (solver/joint_constraint.h).
int substeps_of(const Scene& scene, const InitialBodies& bodies);

}  // namespace collidoscope
