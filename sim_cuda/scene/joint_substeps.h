#pragma once
// Number of substeps that the joints of a scene require.

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// Number of substeps K: the setting, or the value that "auto" resolves to. "auto" is substeps_in_effect()
/// or, with joints, up to 64.
/// Joints: K is large enough that each coupled joint yields at rest by at most 1 % of its span. Its load F is
/// the weight of all connected bodies; it yields by F h^2 n / (4 m) (solver/joint_constraint.h).
int substeps_of(const Scene& scene, const InitialBodies& bodies);

}  // namespace collidoscope
