#pragma once
// The bodies of a scene at time zero as a structure of arrays. Generators are expanded, meshes are loaded,
// masses are computed. SI units.
// An optional array is empty if all its values are the default (zero velocity, unit orientation and so on),
// so unused quantities take no memory.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/aabb.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

class Cancellation;

/// A shape with a vertex list and a face table (the paper's Figure 2). Vertices are relative to the centre of
/// mass and aligned with the principal axes.
struct Mesh {
  std::string name;                ///< path as given in the scene
  std::vector<Vector3d> vertices;  ///< m, relative to the centre of mass, along the principal axes
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< vertex indices, counter-clockwise seen from outside
  double volume = 0;                                ///< m^3, > 0
  Vector3d center{0, 0, 0};                         ///< m, centre of mass in file coordinates
  Quaterniond axes{1, 0, 0, 0};                     ///< rotation from the principal axes to the file's axes
  Vector3d inertia_per_density{0, 0, 0};  ///< m^5, principal moments of inertia divided by the density
  double bounding_radius = 0;  ///< m, radius of the bounding sphere about the centre of mass; currently the
                               ///< collision shape
};

struct InitialBodies {
  std::vector<Vector3d> position;          ///< m; its size is the number of bodies
  std::vector<double> radius;              ///< m, > 0; bounding radius of a mesh
  std::vector<double> mass;                ///< kg, > 0
  std::vector<Vector3d> velocity;          ///< m/s; optional
  std::vector<Vector3d> angular_velocity;  ///< rad/s; optional
  std::vector<Quaterniond> orientation;    ///< rotation from principal axes to world axes; optional
  std::vector<Vector3d> inertia;           ///< kg m^2, principal moments; empty: 2/5 m r^2 for all
  std::vector<std::uint16_t> material;     ///< index into Scene::materials; empty: 0 for all
  std::vector<std::uint32_t> mesh;         ///< 0: sphere; k: meshes[k - 1]; empty: all are spheres
  std::vector<Motion> motion;              ///< empty: all are dynamic
  std::vector<Mesh> meshes;                ///< one entry per file
  std::vector<Aabb> boxes;                 ///< m, instead of the bounds of the bodies; empty: none
  std::shared_ptr<const GivenTree> tree;   ///< over `boxes`, of another program; null: none
  std::optional<Box> box;  ///< container: the scene's box, or the box of the generator's variant

  std::size_t size() const { return position.size(); }
};

/// Expands generators and loads meshes. Generators use Philox4x32-10 (Salmon et al. 2011); the random numbers
/// of a body depend only on its seed and id.
/// `cancellation` may be null. Throws InputError if a value is invalid, a mesh is unreadable or `spawn:
/// apart` finds no room, and Cancelled after a cancellation request.
InitialBodies initial_bodies(const Scene& scene, Cancellation* cancellation = nullptr);

/// The effects that "auto" resolves to in this scene. scene/effects.h lists the conditions.
Effects required_effects(const Scene& scene, const InitialBodies& bodies);

}  // namespace collidoscope
