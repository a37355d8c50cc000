#include "sim_cuda/scene/initial_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/body_table.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/body_file.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/derived_faults.h"
#include "sim_cuda/scene/fault_lines.h"
#include "sim_cuda/scene/joint_substeps.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/mass_properties.h"
#include "sim_cuda/scene/mesh.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

bool is_identity(const Quaterniond& q) { return q.w() == 1 && q.x() == 0 && q.y() == 0 && q.z() == 0; }

/// Loads each mesh file once and assigns it a number from 1 on.
class MeshStore {
 public:
  MeshStore(const Scene& scene, InitialBodies& bodies) : scene_(scene), bodies_(bodies) {}

  std::uint32_t number_of(const std::string& path) {
    const auto [entry, is_new] = numbers_.try_emplace(path, 0);
    if (is_new) {
      bodies_.meshes.push_back(parse_mesh(text_of(path), mesh_file(scene_, path), path));
      entry->second = static_cast<std::uint32_t>(bodies_.meshes.size());
    }
    return entry->second;
  }

 private:
  /// Reads a mesh file. An unreadable file is reported as a fault of the scene, with its line. A fault in the
  /// contents is reported by the mesh parser.
  std::string text_of(const std::string& path) const {
    try {
      return read_mesh_text(mesh_file(scene_, path));
    } catch (const InputError&) {
      throw InputError(fault_lines(scene_, mesh_faults(scene_)));
    }
  }

  const Scene& scene_;
  InitialBodies& bodies_;
  std::map<std::string, std::uint32_t> numbers_;
};

/// Optional arrays that must be filled.
struct Needs {
  bool velocity = false, angular_velocity = false, orientation = false, inertia = false, material = false;
  bool mesh = false, motion = false;
};

/// Appends the bodies of `list`. First fills the optional arrays with defaults for all earlier bodies.
void append_listed(const Scene& scene, const std::vector<Body>& list, MeshStore& meshes, InitialBodies& all,
                   Needs& needs) {
  if (list.empty()) return;
  const std::size_t first = all.size();
  all.velocity.resize(first, Vector3d(0, 0, 0));
  all.angular_velocity.resize(first, Vector3d(0, 0, 0));
  all.orientation.resize(first, Quaterniond(1, 0, 0, 0));
  for (std::size_t i = all.inertia.size(); i < first; ++i)
    all.inertia.push_back(sphere_inertia(all.mass[i], all.radius[i]));
  all.material.resize(first, 0);
  all.mesh.resize(first, 0);
  all.motion.resize(first, Motion::dynamic);
  for (const Body& body : list) {
    const double density = scene.materials[body.material].density;
    const bool is_mesh = body.shape == Shape::mesh;
    const std::uint32_t number = is_mesh ? meshes.number_of(body.mesh) : 0;
    const Mesh* mesh = is_mesh ? &all.meshes[number - 1] : nullptr;
    const double radius = is_mesh ? mesh->bounding_radius : body.radius;
    const double volume = is_mesh ? mesh->volume : sphere_volume(radius);
    const double mass = body.mass ? *body.mass : density * volume;
    // Mesh vertices are stored along the principal axes, which are therefore the body's axes.
    const Quaterniond turn = is_mesh ? body.orientation * mesh->axes : body.orientation;

    all.position.push_back(body.position);
    all.radius.push_back(radius);
    all.mass.push_back(mass);
    all.velocity.push_back(body.velocity);
    all.angular_velocity.push_back(body.angular_velocity);
    all.orientation.push_back(turn);
    if (body.inertia) {
      all.inertia.push_back(*body.inertia);
    } else {
      all.inertia.push_back(is_mesh ? Vector3d(mesh->inertia_per_density * (mass / volume))
                                    : sphere_inertia(mass, radius));
    }
    all.material.push_back(static_cast<std::uint16_t>(body.material));
    all.mesh.push_back(number);
    all.motion.push_back(body.motion);

    needs.velocity |= !body.velocity.isZero(0);
    needs.angular_velocity |= !body.angular_velocity.isZero(0);
    needs.orientation |= !is_identity(turn);
    needs.inertia |= is_mesh || body.inertia.has_value();
    needs.material |= body.material != 0;
    needs.mesh |= is_mesh;
    needs.motion |= body.motion != Motion::dynamic;
  }
}

/// Removes the excluded bodies of a generator. Its bodies must be the last ones in `all`.
void leave_out(const std::vector<std::int64_t>& without, std::size_t first, InitialBodies& all) {
  const auto leave_out_of = [&](auto& array) {
    if (array.size() <= first) return;
    auto next = without.begin();
    std::size_t kept = first;
    for (std::size_t i = first; i < array.size(); ++i) {
      if (next != without.end() && first + static_cast<std::size_t>(*next) == i)
        ++next;
      else
        array[kept++] = array[i];
    }
    array.resize(kept);
  };
  if (without.empty()) return;
  leave_out_of(all.position);
  leave_out_of(all.radius);
  leave_out_of(all.velocity);
}

/// Extends an optional array to full length, or clears it and frees its memory.
template <class Value>
void fill_or_drop(std::vector<Value>& array, bool needed, std::size_t size, const Value& fill) {
  if (needed) {
    array.resize(size, fill);
  } else {
    std::vector<Value>().swap(array);
  }
}

/// True if a body may cross the smallest radius in one substep at its initial speed.
bool crosses_radii(const Scene& scene, const InitialBodies& bodies) {
  if (bodies.size() < 2 || bodies.velocity.empty()) return false;
  double fastest = 0;
  for (const Vector3d& v : bodies.velocity) fastest = std::max(fastest, v.norm());
  const double smallest = *std::min_element(bodies.radius.begin(), bodies.radius.end());
  return fastest * scene.physics.time_step > smallest * substeps_of(scene, bodies);
}

/// The path in the scene that defines a body. For a generated body, `which` describes its index within the
/// generator.
std::string path_of(const Scene& scene, std::size_t body, std::size_t size, std::string& which) {
  if (body < scene.bodies.size()) return fmt::format("bodies[{}]", body);
  const std::size_t first_added = size - scene.extra_bodies.size();
  if (body >= first_added) return fmt::format("extra_bodies[{}]", body - first_added);
  std::size_t first = scene.bodies.size();
  std::string path;
  const auto find_in = [&](const auto& sources, const char* list) {
    for (std::size_t k = 0; k < sources.size() && path.empty(); ++k) {
      const auto count = static_cast<std::size_t>(kept_of(sources[k]));
      if (body < first + count) path = fmt::format("{}[{}]", list, k);
      first += count;
    }
  };
  which = fmt::format("body {}: ", body);
  find_in(scene.generators, "generators");
  find_in(scene.body_files, "body_files");
  return path;
}

/// Checks the ranges of computed values. Inertia is checked only if bodies rotate.
void check_ranges(const Scene& scene, const InitialBodies& all) {
  const bool rotation = bodies_turn(scene);
  std::int64_t generated = 0;
  for (const BoxCollider& generator : scene.generators) generated += kept_of(generator);
  const std::size_t first_generated = scene.bodies.size(),
                    end_generated = first_generated + static_cast<std::size_t>(generated);
  std::vector<Fault> faults;
  const auto fault = [&](std::size_t body, const std::string& what) {
    std::string which;
    const std::string path = path_of(scene, body, all.size(), which);
    faults.push_back({path, which + what});
  };
  for (std::size_t i = 0; i < all.size() && faults.size() < 100; ++i) {
    if (const auto wrong = mass_fault(all.mass[i])) fault(i, *wrong);
    if (rotation) {
      const Vector3d inertia =
          all.inertia.empty() ? sphere_inertia(all.mass[i], all.radius[i]) : all.inertia[i];
      if (const auto wrong = inertia_fault(inertia)) fault(i, *wrong);
    }
    const bool listed = i < first_generated || i >= end_generated;
    if (all.box && listed && !(2 * all.radius[i] <= (all.box->max - all.box->min).minCoeff())) {
      fault(i, fmt::format("its bounding sphere of {:.3g} m radius does not fit between the walls",
                           all.radius[i]));
    }
  }
  if (!faults.empty()) throw InputError(fault_lines(scene, faults));
}

}  // namespace

InitialBodies initial_bodies(const Scene& scene, Cancellation* cancellation) {
  if (const std::vector<Fault> faults = validate(scene); !faults.empty())
    throw InputError(fault_lines(scene, faults));
  InitialBodies all;
  all.box = box_in_effect(scene);
  std::size_t total = static_cast<std::size_t>(bodies_of(scene));
  all.position.reserve(total);
  all.radius.reserve(total);
  all.mass.reserve(total);

  Needs needs;
  MeshStore meshes(scene, all);
  append_listed(scene, scene.bodies, meshes, all, needs);
  for (std::size_t g = 0; g < scene.generators.size(); ++g) {
    const BoxCollider& generator = scene.generators[g];
    const std::size_t first = all.size();
    append_box_collider(generator, all.box.value(),
                        fmt::format("{}generators[{}]", scene.file.empty() ? "" : scene.file + ": ", g), all,
                        cancellation);
    leave_out(generator.excluded, first, all);
    const double density = scene.materials[generator.material].density;
    for (std::size_t i = first; i < all.size(); ++i) {
      all.mass.push_back(static_cast<float>(density * sphere_volume(all.radius[i])));
    }
    needs.velocity |= generator.speed_max > 0;
    if (generator.material != 0) {
      needs.material = true;
      all.material.resize(first, 0);
      all.material.resize(all.size(), static_cast<std::uint16_t>(generator.material));
    }
  }

  for (const BodyFile& file : scene.body_files) {
    append_body_file(file, scene.materials[file.material].density, all);
    needs.velocity |= !file.table->velocity.empty();
    needs.angular_velocity |= !file.table->angular_velocity.empty();
    needs.orientation |= !file.table->orientation.empty();
    needs.material |= file.material != 0;
    needs.motion |= file.boxes;
  }

  append_listed(scene, scene.extra_bodies, meshes, all, needs);
  total = all.size();

  if (needs.inertia) {
    for (std::size_t i = all.inertia.size(); i < total; ++i) {
      all.inertia.push_back(sphere_inertia(all.mass[i], all.radius[i]));
    }
  }
  fill_or_drop(all.inertia, needs.inertia, total, Vector3d(0, 0, 0));
  fill_or_drop(all.velocity, needs.velocity, total, Vector3d(0, 0, 0));
  fill_or_drop(all.angular_velocity, needs.angular_velocity, total, Vector3d(0, 0, 0));
  fill_or_drop(all.orientation, needs.orientation, total, Quaterniond(1, 0, 0, 0));
  fill_or_drop(all.material, needs.material, total, std::uint16_t{0});
  fill_or_drop(all.mesh, needs.mesh, total, std::uint32_t{0});
  fill_or_drop(all.motion, needs.motion, total, Motion::dynamic);
  check_ranges(scene, all);
  return all;
}

Effects required_effects(const Scene& scene, const InitialBodies& bodies) {
  Effects effects;
  const Drag& medium = scene.physics.drag;
  effects.gravity = !scene.physics.gravity.isZero(0);
  effects.attractor = !scene.physics.attractors.empty();
  effects.drag = medium.viscosity > 0 || medium.density * medium.coefficient > 0;
  for (const Material& material : scene.materials) {
    effects.rolling_resistance |= material.rolling_resistance != 0;
    effects.friction |= material.friction != 0 || effects.rolling_resistance;
  }
  effects.joints = !scene.joints.empty();
  effects.rotation = effects.friction || joints_turn_bodies(scene);
  effects.sleeping = scene.physics.sleep.has_value();
  effects.guards = scene.physics.guards.has_value();
  effects.continuous_collision = scene.physics.solver != Solver::impulse && crosses_radii(scene, bodies);
  for (const Vector3d& spin : bodies.angular_velocity) effects.rotation |= !spin.isZero(0);
  return effects;
}

}  // namespace collidoscope
