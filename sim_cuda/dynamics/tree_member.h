#pragma once
// How the joints of a body are solved. Plain data.

#include <cstdint>

namespace collidoscope {

/// none: by iteration, or the body has no joint. touching, free: directly, as part of a tree of joints
/// (solver/joint_tree_solver.h) that touches something, or nothing.
enum class TreeMember : std::uint8_t { none, touching, free };

}  // namespace collidoscope
