#pragma once
// The simulated scene as plain structs in SI units.
// A Scene has the contents of a scene file: generators are not expanded and meshes are not loaded
// (initial_bodies.h does both). It contains everything that affects the state of a run. run_options.h has the
// execution options: executor, launch shape, broad phase.

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/effects.h"
#include "sim_cuda/scene/joint.h"
#include "sim_cuda/scene/named.h"
#include "sim_cuda/scene/time_step.h"

namespace collidoscope {

enum class Precision { f32, f64 };
inline constexpr std::array<Named<Precision>, 2> precision_names{
    {{"f32", Precision::f32, "floats"}, {"f64", Precision::f64, "doubles"}}};

enum class Solver { impulse, soft_step, jacobi_split };
inline constexpr std::array<Named<Solver>, 3> solver_names{
    {{"impulse", Solver::impulse, "the paper's impulses; piles sink"},
     {"soft_step", Solver::soft_step,
      "soft constraints with substeps, solved colour by colour; piles come to rest"},
     // Tonge, Benevolenski, Voroshilov 2012.
     {"jacobi_split", Solver::jacobi_split, "soft_step with mass splitting: all contacts in parallel"}}};

/// Integrator of free motion in a substep: dynamics/integrators.h.
enum class Integrator { semi_implicit_euler, velocity_verlet, rk4 };
inline constexpr std::array<Named<Integrator>, 3> integrator_names{
    {{"semi_implicit_euler", Integrator::semi_implicit_euler, "the paper's integrator, first order"},
     {"velocity_verlet", Integrator::velocity_verlet, "second order; free flight under gravity is exact"},
     {"rk4", Integrator::rk4, "fourth order; free flight under gravity is exact"}}};

/// Rotation of bodies with unequal moments of inertia: dynamics/rotation_updates.h.
enum class RotationUpdate { first_order, lie_group };
inline constexpr std::array<Named<RotationUpdate>, 2> rotation_update_names{
    {{"first_order", RotationUpdate::first_order,
      "the paper's update; conserves angular momentum only: a body with unequal moments of inertia drifts to "
      "rotation about the axis of least inertia, and gains energy"},
     {"lie_group", RotationUpdate::lie_group,
      "second order, fourth order with rk4; free rotation conserves angular momentum and energy for every "
      "step"}}};

/// Closed container. Its six inner faces are walls of the material "default".
struct Box {
  Vector3d min{0, 0, 0}, max{100, 100, 100};  ///< m, min < max on each axis
};

struct Material {
  std::string name = "default";
  double density = 1000;          ///< kg/m^3, > 0
  double restitution = 0.8;       ///< 0 to 1; a pair uses the maximum
  double friction = 0;            ///< Coulomb coefficient, 0 to 100; a pair uses the geometric mean
  double rolling_resistance = 0;  ///< 0 to 10, lever arm divided by radius; a pair uses the maximum
};

enum class Shape { sphere, mesh };
/// Dynamic bodies are moved by forces, kinematic bodies by their prescribed velocity. Fixed bodies ("static")
/// do not move.
enum class Motion { dynamic, kinematic, fixed };

struct Body {
  Shape shape = Shape::sphere;
  Motion motion = Motion::dynamic;
  double radius = 1;           ///< m, > 0, sphere only
  std::string mesh;            ///< path of an OBJ, STL or PLY file, relative to the scene file; mesh only
  Vector3d position{0, 0, 0};  ///< m, centre of mass
  Quaterniond orientation{1, 0, 0, 0};  ///< w x y z; normalised when read
  Vector3d velocity{0, 0, 0};           ///< m/s
  Vector3d angular_velocity{0, 0, 0};   ///< rad/s, world axes
  std::optional<double> mass;           ///< kg, > 0; unset: density x volume
  std::optional<Vector3d> inertia;      ///< kg m^2, principal moments; unset: 2/5 m r^2, or computed from the
                                        ///< mesh
  int material = 0;                     ///< index into Scene::materials
};

/// Growth of the Box Collider's box and radii with N. README.md of this folder has the formulas.
enum class Variant { paper, scaled, settled, equal };
inline constexpr std::array<Named<Variant>, 4> variant_names{
    {{"paper", Variant::paper, "fixed box; pairs grow as N^2"},
     {"scaled", Variant::scaled, "the box grows with N at a fill of 30 %; pairs grow as N"},
     {"settled", Variant::settled, "like scaled, simulated to rest before state 0; needs gravity"},
     {"equal", Variant::equal, "like scaled, with one radius"}}};

/// Distribution of the radii of generated spheres.
enum class Radii { uniform, mostly_small };
inline constexpr std::array<Named<Radii>, 2> radii_names{
    {{"uniform", Radii::uniform, "uniform in (0, radius_max]"},
     {"mostly_small", Radii::mostly_small,
      "from radius_max/16 to radius_max, half of them below radius_max/5"}}};

/// Allowed start positions of generated spheres.
enum class Spawn { inside, centres, apart };
inline constexpr std::array<Named<Spawn>, 3> spawn_names{
    {{"inside", Spawn::inside, "whole spheres lie within the walls"},
     {"centres", Spawn::centres, "centres lie within the walls"},
     {"apart", Spawn::apart, "like inside, without overlap"}}};

/// Generator of the paper's benchmark: `count` spheres with radii uniform in (0, radius_max], or all of one
/// radius ("equal").
struct BoxCollider {
  std::int64_t count = 2000;  ///< number of bodies, 0 to 2^27
  double radius_max = 5;      ///< m, 1e-3 to 1e9
  Radii radii = Radii::uniform;
  Variant variant = Variant::paper;
  Spawn spawn = Spawn::inside;
  std::uint64_t seed = 1;
  double speed_max = 0;  ///< m/s, >= 0: each velocity component is uniform in [-speed_max, speed_max)
  int material = 0;
  /// Indices of removed bodies among the `count`, ascending. The other bodies are unchanged; their ids shift
  /// down.
  std::vector<std::int64_t> excluded{};
};

struct BodyTable;
struct GivenTree;

/// Spheres of a foreign file, a row for each: NPY, NPZ, CSV, XYZ, LAMMPS dump or PLY. Or boxes, which are
/// inspected and not simulated: a scene with boxes has no other bodies.
struct BodyFile {
  std::string path;              ///< relative to the scene file, in its folder
  std::string columns;           ///< "x=1,radius=r", in addition to the names in the file
  double scale = 1;              ///< m per unit of length in the file, > 0
  std::optional<double> radius;  ///< m, > 0; required if the file has no radii
  std::int64_t frame = 0;        ///< of a file with several, from 0
  bool boxes = false;  ///< a row has the minimum and the maximum of a box; or boxes of a mesh's triangles
  std::string tree;    ///< of the boxes: path of a tree over them, or empty
  int material = 0;
  std::vector<std::int64_t> excluded{};  ///< indices of removed rows, as in BoxCollider
  /// The contents of the file, read with the scene. Not written to scene files.
  std::shared_ptr<const BodyTable> table{};
  std::shared_ptr<const GivenTree> given_tree{};
};

/// A fixed half-space. Bodies stay where normal . x >= offset.
struct Plane {
  Vector3d normal{0, 0, 1};  ///< unit length; normalised when read
  double offset = 0;         ///< m
  int material = 0;
};

/// A fixed box. Bodies stay outside.
struct BoxObstacle {
  Vector3d center{0, 0, 0};             ///< m
  Vector3d size{1, 1, 1};               ///< m, full edge lengths, > 0
  Quaterniond orientation{1, 0, 0, 0};  ///< w x y z; normalised when read
  int material = 0;
};

/// The medium around all bodies; see dynamics/drag.h.
struct Drag {
  double viscosity = 0;       ///< Pa s, >= 0
  double density = 0;         ///< kg/m^3, >= 0
  double coefficient = 0.47;  ///< >= 0, of a sphere in turbulent flow
};

/// A point that attracts all bodies; see dynamics/attractor.h.
struct Attractor {
  Vector3d position{0, 0, 0};  ///< m
  double strength = 0;         ///< m^3/s^2, G M; negative: repels
  double softening = 1;        ///< m, > 0: softening length; the force stops growing within this distance
};

/// Largest acceleration of one attractor at any point, in m/s^2.
inline double max_field(const Attractor& attractor) {
  return std::abs(attractor.strength) * 2 / (3 * std::sqrt(3.0) * attractor.softening * attractor.softening);
}

/// Camera of the pictures. Unset members frame the whole scene.
struct Camera {
  std::optional<Vector3d> position, target;  ///< m
  Vector3d up{0, 0, 1};
  double vertical_field_of_view = 40;  ///< degrees, 1 to 150
};

/// Sleep condition of an island of touching bodies: all of them are slower than `speed` for `time`.
struct Sleep {
  double speed = 0.01;  ///< m/s, >= 0, of the centre and of the rotating surface
  double time = 0.5;    ///< s, >= 0
};

/// Reaction to a guard finding (guard/stage_validator.h). pause: the run stops before the step. freeze: the
/// step is repeated with the body fixed at its place.
enum class OnFailure { pause, freeze };
/// Thresholds of the guards, in addition to the check for finite values. The defaults are at least ten times
/// the largest initial values of a scene.
struct ValidationSettings {
  OnFailure on_failure = OnFailure::pause;
  double speed = 1e10;     ///< m/s, >= 0; maximum speed
  double distance = 1e10;  ///< m, >= 0; maximum distance of a centre from the origin, and of a bounding box
                           ///< along an axis
  double angular_speed = 1e10;  ///< rad/s, >= 0; maximum angular speed
};

/// The physical settings. Together with the bodies they determine the state.
struct Physics {
  Vector3d gravity{0, 0, -9.81};  ///< m/s^2
  Drag drag;                      ///< default: no drag
  std::vector<Attractor> attractors;
  TimeStep time_step;           ///< s, > 0
  std::optional<int> substeps;  ///< K, 1 to 1000, each of time_step / K; unset: "auto"
  int iterations = 1;           ///< solver iterations over all contacts, 1 to 1000
  Solver solver = Solver::soft_step;
  Integrator integrator = Integrator::velocity_verlet;
  RotationUpdate rotation_update = RotationUpdate::lie_group;
  Precision precision = Precision::f32;
  std::optional<Effects> effects;               ///< unset: "auto", the effects that the scene requires
  std::optional<double> restitution_threshold;  ///< m/s; unset: "auto", 2 |gravity| h
  std::optional<Sleep> sleep;                   ///< unset: sleeping is off
  std::optional<ValidationSettings> guards;     ///< unset: no validation; affects the state only if a body is
                                                ///< frozen
};

/// Turns guards off for benchmarks and comparisons, which cannot handle a pause.
inline void disable_guards(Physics& physics) {
  physics.guards.reset();
  if (physics.effects) physics.effects->guards = false;
}

/// Number of substeps K: the setting, or the value that "auto" resolves to. Soft contacts need substeps;
/// `impulse` follows the paper and has one.
inline int substeps_in_effect(const Physics& physics) {
  return physics.substeps.value_or(physics.solver == Solver::impulse ? 1 : 4);
}

struct Scene {
  std::string name = "unnamed";
  std::string directory = ".";        ///< base of relative mesh paths; not written to files
  std::string file;                   ///< source file, for messages; not written to files
  std::vector<std::string> warnings;  ///< lines for the user: old names in the file, what an import assumed;
                                      ///< not written to files
  std::optional<Box> box;             ///< unset: no walls
  Physics physics;
  std::vector<Material> materials{Material{}};  ///< materials[0] is always "default"
  std::vector<Body> bodies;                     ///< ids 0, 1, ... in order
  std::vector<BoxCollider> generators;          ///< their ids follow, generator by generator
  std::vector<BodyFile> body_files;             ///< their ids follow, file by file
  std::vector<Body> extra_bodies;               ///< bodies added during a run; their ids are the last ones
  std::vector<Plane> obstacles;
  std::vector<BoxObstacle> boxes;  ///< listed among the obstacles in files
  std::vector<Joint> joints;
  Camera camera;
};

}  // namespace collidoscope
