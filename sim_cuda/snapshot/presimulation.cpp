#include "sim_cuda/snapshot/presimulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/deadline.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/run/settled_state.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"

namespace collidoscope {
namespace {

constexpr int stride = 30;              // steps between checks
constexpr double lift = 1.0 / 20'000;   // lift height at rest, in largest radii
constexpr double longest_falls = 20;    // upper limit of the time, in T
constexpr double slower_in_a_fall = 4;  // damping: velocity ratio 1/(1 + this * t/T)

PresimulationCallbacks& presimulation_callbacks() {
  static PresimulationCallbacks for_all;
  return for_all;
}

void log_presimulation(const std::string& line) {
  if (presimulation_callbacks().log) presimulation_callbacks().log(line);
}

/// The scene for the pre-simulation. Name and camera are removed, since they do not affect the result.
Scene falling(const Scene& scene) {
  Scene inner = scene;
  inner.name = "";
  inner.camera = {};
  for (BoxCollider& generator : inner.generators)
    if (generator.variant == Variant::settled) generator.variant = Variant::scaled;
  Physics& physics = inner.physics;
  physics.sleep.reset();
  if (physics.effects) physics.effects->sleeping = false;
  disable_guards(physics);
  if (physics.solver != Solver::impulse) return inner;
  physics.solver = Solver::soft_step;
  physics.substeps.reset();
  physics.iterations = 1;
  return inner;
}

std::uint64_t hash_of(const std::string& text, std::uint64_t hash = 0) {
  for (const char letter : text) hash = mix64(hash ^ static_cast<unsigned char>(letter));
  return hash;
}

/// State hash of a small scene under the same physics. Changes if the simulation code changes its results.
std::uint64_t stepping_fingerprint(const Physics& physics) {
  Scene probe;
  probe.box = Box{{0, 0, 0}, {30, 30, 30}};
  probe.physics = physics;
  probe.materials[0].friction = 0.5;
  probe.generators.push_back({.count = 120, .speed_max = 5});
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  options.cpu_threads = 1;
  World world(probe, options);
  world.step(30);
  return world.state_hash();
}

/// Empty if the user has no cache folder.
std::filesystem::path cache_file(const Scene& inner) {
  const std::filesystem::path folder = cache_folder();
  if (folder.empty()) return folder;
  std::uint64_t key = hash_of(write_scene(inner), stepping_fingerprint(inner.physics));
  key = hash_of(fmt::format("{} {} {} {} {} {}", snapshot_version, physics_version, stride, lift,
                            longest_falls, slower_in_a_fall),
                key);
  return folder / "settled" / fmt::format("{:016x}.snapshot", key);
}

std::optional<RunState> cached(const std::filesystem::path& file, const Scene& inner) {
  std::error_code failed;
  if (file.empty() || !std::filesystem::exists(file, failed)) return std::nullopt;
  try {
    Snapshot kept = read_snapshot(file.string());
    if (write_scene(kept.scene) == write_scene(inner) &&
        kept.bodies_hash == hash_of_bodies(initial_bodies(inner)))
      return std::move(kept.state);
  } catch (const InputError& error) {
    log_presimulation(std::string(error.what()) + "; the presimulation is computed again");
  }
  return std::nullopt;
}

void keep(const std::filesystem::path& file, const Snapshot& snapshot) {
  if (file.empty()) return;
  try {
    std::string bytes;
    write_snapshot(snapshot, [&](std::string_view more) { bytes += more; });
    write_file_atomically(file.string(), bytes);
  } catch (const std::exception& error) {
    log_presimulation(fmt::format("the presimulation is not cached: {}", error.what()));
  }
}

double largest(const std::vector<double>& radii) {
  return radii.empty() ? 0 : *std::ranges::max_element(radii);
}

/// Multiplies all velocities and angular velocities by `share`.
void slow_down(World& world, double share) {
  RunState state = world.state();
  for (Vector3d& v : state.bodies.velocity) v *= share;
  for (Vector3d& spin : state.bodies.angular_velocity) spin *= share;
  world.restore(state);
}

}  // namespace

double energy_at_rest(double mass, double g, double radius) { return mass * g * lift * radius; }

struct Presimulation::Impl {
  Impl(const Scene& scene, const RunOptions& options) : inner(falling(scene)), file(cache_file(inner)) {
    state = cached(file, inner);
    if (!state) fall(options);
  }
  /// Starts the simulation.
  void fall(const RunOptions& options) {
    world = std::make_unique<World>(inner, options);
    const InitialBodies& bodies = world->initial();
    const double g = inner.physics.gravity.norm(), step = inner.physics.time_step;
    at_rest = energy_at_rest(std::accumulate(bodies.mass.begin(), bodies.mass.end(), 0.0), g,
                             largest(bodies.radius));
    const double side = (bodies.box->max - bodies.box->min).maxCoeff();
    fall_time = std::sqrt(2 * side / g);
    max_steps = static_cast<std::int64_t>(std::clamp(std::ceil(longest_falls * fall_time / step), 1.0, 1e9));
    share = 1 / (1 + stride * step * slower_in_a_fall / fall_time);
  }
  std::int64_t next_look() const { return std::min((world->steps() / stride + 1) * stride, max_steps); }

  /// Checks for rest. If not at rest, damps the velocities.
  void look() {
    const double energy = world->measure().kinetic_energy;
    if (presimulation_callbacks().progress) presimulation_callbacks().progress(world->steps(), max_steps);
    const double time = static_cast<double>(world->steps()) * inner.physics.time_step;
    const bool fallen = time > fall_time;  // otherwise bodies are still slow at the start of the fall
    const bool rests = fallen && energy <= at_rest;
    if (!rests && world->steps() < max_steps) {
      if (fallen) slow_down(*world, share);
      return;
    }
    if (!rests)
      log_presimulation(fmt::format(
          "not at rest after {} steps: the kinetic energy is {:.3g} J, the limit of rest is {:.3g} J",
          max_steps, energy, at_rest));
    if (presimulation_callbacks().progress) presimulation_callbacks().progress(max_steps, max_steps);
    Snapshot snapshot = snapshot_of(*world);
    keep(file, snapshot);
    state = std::move(snapshot.state);
    world.reset();
  }

  Scene inner;
  std::filesystem::path file;
  std::optional<RunState> state;  // set when done
  std::unique_ptr<World> world;   // null when done
  double at_rest = 0;             // J
  double fall_time = 0;           // T, s
  double share = 1;               // velocity ratio per check
  std::int64_t max_steps = 0;
};

Presimulation::Presimulation(const Scene& scene, const RunOptions& options)
    : impl_(std::make_unique<Impl>(scene, options)) {}
Presimulation::~Presimulation() = default;
Presimulation::Presimulation(Presimulation&&) noexcept = default;
Presimulation& Presimulation::operator=(Presimulation&&) noexcept = default;

bool Presimulation::done() const { return impl_->state.has_value(); }
std::int64_t Presimulation::steps() const { return impl_->world ? impl_->world->steps() : impl_->max_steps; }
std::int64_t Presimulation::max_steps() const { return impl_->max_steps; }

void Presimulation::advance(double milliseconds) {
  const Deadline slice(milliseconds);
  while (!done()) {
    World& world = *impl_->world;
    const std::int64_t look = impl_->next_look();
    world.step(std::isfinite(milliseconds) ? 1 : static_cast<int>(look - world.steps()));
    if (world.steps() == look) impl_->look();
    if (slice.passed()) break;
  }
}

RunState Presimulation::take() {
  RunState& state = *impl_->state;
  state.steps = 0;
  state.time = 0;
  state.static_impulses.assign(state.static_impulses.size(), StaticImpulse{});
  return std::move(state);
}

RunState settled_state(const Scene& scene, const RunOptions& options) {
  Presimulation settling(scene, options);
  settling.advance(std::numeric_limits<double>::infinity());
  return settling.take();
}

void set_presimulation_callbacks(PresimulationCallbacks told) { presimulation_callbacks() = std::move(told); }

}  // namespace collidoscope
