#include "sim_cuda/scene/derived_faults.h"

#include <fmt/format.h>

#include <map>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/mesh.h"
#include "sim_cuda/scene/placed_joint.h"

namespace collidoscope {
namespace {

/// A mesh, or the first fault of its file.
struct MeshOrFault {
  std::optional<Mesh> mesh;
  std::string fault;
};

MeshOrFault read(const Scene& scene, const std::string& path) {
  try {
    return {read_mesh(mesh_file(scene, path), path), ""};
  } catch (const InputError& error) {
    const std::size_t others = error.lines().size() - 1;
    return {std::nullopt, error.lines().front() + (others > 0 ? fmt::format(" (and {} more)", others) : "")};
  }
}

}  // namespace

std::optional<std::string> mass_fault(double mass, const std::string& whose) {
  if (mass >= limits::min_mass && mass <= limits::max_mass) return std::nullopt;
  return fmt::format("{} mass would be {:.3g} kg (density times volume); it must be in [{}, {}] kg", whose,
                     mass, limits::min_mass, limits::max_mass);
}

std::optional<std::string> inertia_fault(const Vector3d& inertia) {
  if (inertia.minCoeff() >= limits::min_inertia && inertia.maxCoeff() <= limits::max_inertia)
    return std::nullopt;
  return fmt::format(
      "its moment of inertia would be {:.3g} kg m^2; with rotation it must be in [{}, {}] kg m^2",
      inertia.minCoeff() < limits::min_inertia ? inertia.minCoeff() : inertia.maxCoeff(), limits::min_inertia,
      limits::max_inertia);
}

bool bodies_turn(const Scene& scene) {
  if (scene.physics.effects) return scene.physics.effects->rotation;
  for (const Material& material : scene.materials)
    if (material.friction != 0 || material.rolling_resistance != 0) return true;
  for (const auto* list : {&scene.bodies, &scene.extra_bodies})
    for (const Body& body : *list)
      if (!body.angular_velocity.isZero(0)) return true;
  return joints_turn_bodies(scene);
}

std::vector<Fault> mesh_faults(const Scene& scene) {
  std::vector<Fault> faults;
  std::map<std::string, MeshOrFault> meshes;
  const auto check = [&](const Body& body, const std::string& path) {
    if (body.shape != Shape::mesh || body.mesh.empty()) return;
    auto entry = meshes.find(body.mesh);
    if (entry == meshes.end()) entry = meshes.emplace(body.mesh, read(scene, body.mesh)).first;
    const auto& [mesh, fault] = entry->second;
    if (!mesh) {
      faults.push_back({path + ".mesh", fault});
    } else if (!body.mass && body.material >= 0 &&
               static_cast<std::size_t>(body.material) < scene.materials.size()) {
      const double density = scene.materials[static_cast<std::size_t>(body.material)].density;
      const bool good_density = density >= limits::min_density && density <= limits::max_density;
      if (const auto wrong = mass_fault(density * mesh->volume); wrong && good_density)
        faults.push_back({path, *wrong});
    }
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) check(scene.bodies[i], fmt::format("bodies[{}]", i));
  for (std::size_t i = 0; i < scene.extra_bodies.size(); ++i)
    check(scene.extra_bodies[i], fmt::format("extra_bodies[{}]", i));
  return faults;
}

}  // namespace collidoscope
