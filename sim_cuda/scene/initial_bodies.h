#pragma once
// The bodies of a scene at time zero, one array per quantity: generators expanded, meshes loaded, masses
// worked out. Arrays that hold nothing but the default are empty (no velocity: all at rest; no orientation:
// all q = 1...), so that what a scene does not call for is never stored.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

class Cancellation;

/// The paper's shape attribute (its Figure 2): a vertex list and a face table, moved to the centre of mass
/// and turned to the principal axes.
struct Mesh {
  std::string name;                                 ///< path as the scene gives it
  std::vector<Vector3d> vertices;                   ///< m, from the centre of mass, along the principal axes
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< counter-clockwise seen from outside
  double volume = 0;                                ///< m^3, > 0
  Vector3d center{0, 0, 0};                         ///< m, the centre of mass in the file's coordinates
  Quaterniond axes{1, 0, 0, 0};                     ///< turns the principal axes into the file's axes
  Vector3d inertia_per_density{0, 0, 0};            ///< m^5, principal moments over density
  double bounding_radius = 0;  ///< m, of the sphere about the centre of mass: what collides for now
};

struct InitialBodies {
  std::vector<Vector3d> position;          ///< m; size() bodies
  std::vector<double> radius;              ///< m, > 0; a mesh's bounding radius
  std::vector<double> mass;                ///< kg, > 0
  std::vector<Vector3d> velocity;          ///< m/s, or empty
  std::vector<Vector3d> angular_velocity;  ///< rad/s, or empty
  std::vector<Quaterniond> orientation;    ///< or empty. Turns the body's principal axes into world axes
  std::vector<Vector3d> inertia;           ///< kg m^2, principal moments, or empty: 2/5 m r^2 for all
  std::vector<std::uint16_t> material;     ///< index into Scene::materials, or empty: all 0
  std::vector<std::uint32_t> mesh;         ///< 0: a sphere; k: meshes[k - 1]; or empty: all spheres
  std::vector<Motion> motion;              ///< or empty: all dynamic
  std::vector<Mesh> meshes;                ///< each file once
  std::optional<Box> box;                  ///< the scene's, or the one that the generator's variant sets

  std::size_t size() const { return position.size(); }
};

/// Expands generators (Philox4x32-10: Salmon et al. 2011; a body's draws depend on its seed and id alone),
/// loads meshes. Throws InputError where a mesh cannot be read, or `spawn: apart` finds no room; Cancelled
/// where `cancellation` (may be null) was requested.
InitialBodies initial_bodies(const Scene& scene, Cancellation* cancellation = nullptr);

/// The effects that `"auto"` stands for in this scene; scene/effects.h says what calls for each.
Effects required_effects(const Scene& scene, const InitialBodies& bodies);

}  // namespace collidoscope
