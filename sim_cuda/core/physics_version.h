#pragma once
// Number of the simulated physics. Snapshots and results contain it, because state hashes of different
// versions cannot be compared.

namespace collidoscope {

/// Version 1 is everything up to release 0.1.0. A commit that changes the states of any scene raises this
/// number and says so in CHANGELOG.md.
inline constexpr int physics_version = 23;

/// Version of files that do not contain the number.
inline constexpr int first_physics_version = 1;

}  // namespace collidoscope
