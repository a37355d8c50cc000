#pragma once
// Number of substeps that the joints of a scene require.

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// Number of substeps K: the setting, or the value that "auto" resolves to. "auto" is substeps_in_effect()
/// or, with iterated joints, up to 64.
/// Joints: F h^2 n / (4 m) is at most 1 % of the joint's span, where F is the weight of all connected bodies,
/// n the largest number of joints at one of its bodies, and m its effective mass. A chain then stretches by
/// about 1 % when it swings.
int substeps_of(const Scene& scene, const InitialBodies& bodies);

/// Number of substeps that iterated joints call for if it is more than "auto" gives; otherwise 0.
double substeps_missed(const Scene& scene, const InitialBodies& bodies);

}  // namespace collidoscope
