#pragma once
// What is simulated, as plain structs in SI units. A Scene is what a scene file says, no more: generators are
// not yet expanded and meshes are not yet loaded (initial_bodies.h does both). Everything that decides the
// state of a run is in here; how and where it runs (executor, launch shape, broad phase) is in run_options.h.

#include <array>
#include <cmath>
#include <cstdint>
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
    {{"impulse", Solver::impulse, "the paper's immediate impulses; piles sink"},
     {"soft_step", Solver::soft_step, "soft constraints in substeps, colour by colour; piles come to rest"},
     // Tonge, Benevolenski, Voroshilov 2012.
     {"jacobi_split", Solver::jacobi_split, "soft_step with mass splitting: all contacts at once"}}};

/// How free motion is integrated in a substep: dynamics/integrators.h.
enum class Integrator { semi_implicit_euler, velocity_verlet, rk4 };
inline constexpr std::array<Named<Integrator>, 3> integrator_names{
    {{"semi_implicit_euler", Integrator::semi_implicit_euler, "the paper's, first order"},
     {"velocity_verlet", Integrator::velocity_verlet, "second order"},
     {"rk4", Integrator::rk4, "fourth order"}}};

enum class RotationUpdate { first_order, lie_group };
inline constexpr std::array<Named<RotationUpdate>, 2> rotation_update_names{
    {{"first_order", RotationUpdate::first_order, "the paper's"},
     {"lie_group", RotationUpdate::lie_group,
      "second order, with rk4 fourth; free rotation keeps its energy"}}};

/// The closed container; its six inner faces are walls of the material "default".
struct Box {
  Vector3d min{0, 0, 0}, max{100, 100, 100};  ///< m, min < max on each axis
};

struct Material {
  std::string name = "default";
  double density = 1000;          ///< kg/m^3, > 0
  double restitution = 0.8;       ///< 0 to 1; a pair takes the larger of the two
  double friction = 0;            ///< Coulomb's coefficient, 0 to 100; a pair takes the geometric mean
  double rolling_resistance = 0;  ///< 0 to 10, lever over radius; a pair takes the larger of the two
};

enum class Shape { sphere, mesh };
/// Dynamic bodies are moved by forces, kinematic ones by their own velocity, fixed ones ("static") never.
enum class Motion { dynamic, kinematic, fixed };

struct Body {
  Shape shape = Shape::sphere;
  Motion motion = Motion::dynamic;
  double radius = 1;                    ///< m, > 0, sphere only
  std::string mesh;                     ///< path of an OBJ file, relative to the scene file; mesh only
  Vector3d position{0, 0, 0};           ///< m, of the centre of mass
  Quaterniond orientation{1, 0, 0, 0};  ///< w x y z; normalised on reading
  Vector3d velocity{0, 0, 0};           ///< m/s
  Vector3d angular_velocity{0, 0, 0};   ///< rad/s, world axes
  std::optional<double> mass;           ///< kg, > 0; else density x volume
  std::optional<Vector3d> inertia;      ///< kg m^2, principal moments; else 2/5 m r^2, or the mesh's own
  int material = 0;                     ///< index into Scene::materials
};

/// How the Box Collider's box and radii grow with N; README.md of this folder has the formulas.
enum class Variant { paper, scaled, settled, equal };
inline constexpr std::array<Named<Variant>, 4> variant_names{
    {{"paper", Variant::paper, "fixed box; pairs grow as N^2"},
     {"scaled", Variant::scaled, "the box grows with N, 30 % full; pairs grow as N"},
     {"settled", Variant::settled, "as scaled, simulated to rest before state 0; needs gravity"},
     {"equal", Variant::equal, "as scaled, with one radius"}}};

/// Where generated spheres may start.
enum class Spawn { inside, centres, apart };
inline constexpr std::array<Named<Spawn>, 3> spawn_names{
    {{"inside", Spawn::inside, "whole spheres lie within the walls"},
     {"centres", Spawn::centres, "centres lie within the walls"},
     {"apart", Spawn::apart, "as inside, and no two overlap"}}};

/// The paper's benchmark: `count` spheres with radii uniform in (0, radius_max], or all of one radius
/// ("equal").
struct BoxCollider {
  std::int64_t count = 2000;  ///< bodies, 0 to 2^27
  double radius_max = 5;      ///< m, 1e-3 to 1e9
  Variant variant = Variant::paper;
  Spawn spawn = Spawn::inside;
  std::uint64_t seed = 1;
  double speed_max = 0;  ///< m/s, >= 0: each velocity component is uniform in [-speed_max, speed_max)
  int material = 0;
  /// Bodies that were taken away: their numbers among the `count`, ascending. The others are as they were,
  /// and their ids move up.
  std::vector<std::int64_t> without{};
};

/// A half-space that never moves: bodies stay where normal . x >= offset.
struct Plane {
  Vector3d normal{0, 0, 1};  ///< unit length; normalised on reading
  double offset = 0;         ///< m
  int material = 0;
};

/// A box that never moves: bodies stay outside of it.
struct BoxObstacle {
  Vector3d center{0, 0, 0};             ///< m
  Vector3d size{1, 1, 1};               ///< m, whole edges, > 0
  Quaterniond orientation{1, 0, 0, 0};  ///< w x y z; normalised on reading
  int material = 0;
};

/// The medium that all bodies move through; see dynamics/drag.h.
struct Drag {
  double viscosity = 0;       ///< Pa s, >= 0
  double density = 0;         ///< kg/m^3, >= 0
  double coefficient = 0.47;  ///< >= 0, of a sphere in turbulent flow
};

/// A point that pulls all bodies; see dynamics/attractor.h.
struct Attractor {
  Vector3d position{0, 0, 0};  ///< m
  double strength = 0;         ///< m^3/s^2, G M; below 0 it repels
  double softening = 1;        ///< m, > 0: nearer than this the pull grows no more
};

/// m/s^2, the most that one attractor pulls anywhere.
inline double max_field(const Attractor& attractor) {
  return std::abs(attractor.strength) * 2 / (3 * std::sqrt(3.0) * attractor.softening * attractor.softening);
}

/// Where the pictures are taken from; unset fields frame the whole scene.
struct Camera {
  std::optional<Vector3d> position, target;  ///< m
  Vector3d up{0, 0, 1};
  double vertical_field_of_view = 40;  ///< degrees, 1 to 150
};

/// When an island of bodies that touch each other falls asleep: all of them were slow for a while.
struct Sleep {
  double speed = 0.05;  ///< m/s, >= 0, of a centre and of a surface that turns; slower is slow
  double time = 0.5;    ///< s, >= 0
};

/// What becomes of a step in which a guard finds something (guard/stage_validator.h): the run waits before
/// it, or it is done again with the body fixed where it was.
enum class OnFailure { pause, freeze };
/// What guards take for absurd, beside what is not finite: ten times and more what a scene may start with.
struct ValidationSettings {
  OnFailure on_failure = OnFailure::pause;
  double speed = 1e10;     ///< m/s, >= 0; faster is absurd
  double distance = 1e10;  ///< m, >= 0, from the origin; a centre farther off is absurd, and a box on an axis
  double spin = 1e10;      ///< rad/s, >= 0; faster is absurd
};

/// The physical settings: with the bodies, they alone decide the state.
struct Physics {
  Vector3d gravity{0, 0, -9.81};  ///< m/s^2
  Drag drag;                      ///< none by default
  std::vector<Attractor> attractors;
  TimeStep time_step;           ///< s, > 0
  std::optional<int> substeps;  ///< K, 1 to 1000, each over time_step / K; unset: "auto"
  int iterations = 1;           ///< of the solver over all contacts, 1 to 1000
  Solver solver = Solver::soft_step;
  Integrator integrator = Integrator::semi_implicit_euler;
  RotationUpdate rotation_update = RotationUpdate::first_order;
  Precision precision = Precision::f32;
  std::optional<Effects> effects;               ///< unset: "auto", what the scene calls for
  std::optional<double> restitution_threshold;  ///< m/s; unset: "auto", 2 |gravity| h
  std::optional<Sleep> sleep;                   ///< unset: nothing falls asleep
  std::optional<ValidationSettings> guards;     ///< unset: nobody looks; decides no state but a frozen one
};

/// For who compares or times runs, and could make nothing of a pause.
inline void disable_guards(Physics& physics) {
  physics.guards.reset();
  if (physics.effects) physics.effects->guards = false;
}

/// K as set, or what "auto" comes to: soft contacts live of their substeps, `impulse` is the paper's without
/// them.
inline int substeps_in_effect(const Physics& physics) {
  return physics.substeps.value_or(physics.solver == Solver::impulse ? 1 : 4);
}

struct Scene {
  std::string name = "unnamed";
  std::string directory = ".";  ///< where relative mesh paths start; not written to files
  std::string file;             ///< what it was read from, for messages; not written to files
  std::optional<Box> box;       ///< unset: no walls
  Physics physics;
  std::vector<Material> materials{Material{}};  ///< materials[0] is always "default"
  std::vector<Body> bodies;                     ///< ids 0, 1, ... in order
  std::vector<BoxCollider> generators;          ///< their bodies follow, generator by generator
  std::vector<Body> added;                      ///< theirs follow these: bodies that came in mid-run
  std::vector<Plane> obstacles;
  std::vector<BoxObstacle> boxes;  ///< in files they stand among the obstacles
  std::vector<Joint> joints;
  Camera camera;
};

}  // namespace collidoscope
