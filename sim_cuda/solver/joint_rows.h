#pragma once
// Constant data of joints: parameters of the constraints, and colours. Host code.

#include <cstdint>
#include <vector>

#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/solver/joint_state.h"

namespace collidoscope {

/// `bodies`: at time zero. `moves`: by body, true if dynamic. `joint_count`: largest number of joints at one
/// of the bodies. `max_correction_speed` in m/s. `h`: substep, s.
template <class Real>
JointRow<Real> row_of(const PlacedJoint& joint, const InitialBodies& bodies, const std::vector<bool>& moves,
                      std::uint32_t joint_count, double max_correction_speed, double h);

/// Colour of each joint that is not in a tree, first fit in scene order; 0 for all others. `moves`: by body,
/// true if dynamic.
std::vector<std::size_t> colours_of(const std::vector<PlacedJoint>& joints, const std::vector<bool>& in_tree,
                                    const std::vector<bool>& moves);

}  // namespace collidoscope
