#pragma once
// Range checks of derived values: masses from densities, moments of inertia, contents of mesh files.
// Functions return faults as messages without a location; they do not throw.

#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

/// Checks a mass in kg that was computed from a density. Returns a message, or nothing if it is in range.
/// `whose` starts the message: "its", "its largest sphere's".
std::optional<std::string> mass_fault(double mass, const std::string& whose = "its");
/// Checks principal moments of inertia in kg m^2. They matter only if bodies rotate.
std::optional<std::string> inertia_fault(const Vector3d& inertia);

/// True if the effect rotation is on, either in the list of effects or because a body or joint requires it.
bool bodies_turn(const Scene& scene);

/// Faults of the mesh files that bodies refer to. Reads all of these files.
/// Reports the first fault of each file that is unreadable or not a closed mesh, and each body with a mass
/// out of range.
std::vector<Fault> mesh_faults(const Scene& scene);

}  // namespace collidoscope
