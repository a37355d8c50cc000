#pragma once
// Ranges of values that follow from others: masses from densities, moments of inertia, what mesh files hold.

#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

/// What is wrong with a mass (kg) that follows from a density, or nothing. `whose`: "its", "its largest
/// sphere's".
std::optional<std::string> mass_fault(double mass, const std::string& whose = "its");
/// The same of principal moments of inertia, kg m^2. They count only where bodies turn.
std::optional<std::string> inertia_fault(const Vector3d& inertia);

/// Whether the effect rotation is on: as the list of effects says, or because something turns bodies.
bool bodies_turn(const Scene& scene);

/// Faults of the mesh files that bodies name: each file that cannot be read or is no closed mesh (its first
/// fault), and bodies whose mass is out of range. Reads all of these files.
std::vector<Fault> mesh_faults(const Scene& scene);

}  // namespace collidoscope
