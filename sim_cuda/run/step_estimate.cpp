#include "sim_cuda/run/step_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/host_memory.h"
#include "sim_cuda/run/sampled_pairs.h"
#include "sim_cuda/run/simulation_state.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {
namespace {

constexpr std::int64_t few_bodies = 3000;  // all their pairs fit in memory and are found in seconds
constexpr double long_step = 5;            // limit for a warning, s
constexpr std::int64_t longest_list = 2147483647;

// Upper bounds in bytes for every solver and precision, with all effects.
constexpr double most_bytes_of_body = 4096, most_bytes_of_pair = 64, most_bytes_of_contact = 1024;
// Lower bounds in bytes per body: scene data on the host, and buffers.
constexpr std::int64_t least_bytes_on_host = 60, least_bytes_in_buffers = 100;

// Times on one CPU core, ns (Xeon at 2.x GHz, float).
constexpr double ns_of_body = 500, ns_of_body_in_substep = 300, ns_of_pair = 130, ns_of_contact = 700,
                 ns_of_contact_in_substep = 100, ns_of_contact_in_sweep = 130;

MovingSpheres spheres_of(const WorldSetup& setup) {
  const auto& [broad_phase, scene, initial, effects, substeps, start, ids, capacity] = setup;
  MovingSpheres spheres{initial.position, initial.radius, initial.velocity};
  if (start != nullptr) {
    const BodyStates& states = start->bodies;
    spheres.velocity.resize(initial.size(), Vector3d(0, 0, 0));
    for (std::size_t body = 0; body < states.position.size(); ++body) {
      const std::size_t now = ids.empty() ? body : ids[body];
      if (now >= initial.size()) continue;
      spheres.position[now] = states.position[body];
      spheres.velocity[now] = states.velocity[body];
    }
  }
  const Physics& physics = scene.physics;
  if (physics.solver == Solver::impulse) return spheres;
  double acceleration = effects.gravity ? physics.gravity.norm() : 0;
  for (const Attractor& attractor : physics.attractors)
    if (effects.attractor) acceleration += 2 * max_field(attractor);
  const double time = physics.time_step;
  spheres.margin = {motion_bound(effects), nullptr, time, time * time * acceleration, max_restitution(scene)};
  return spheres;
}

/// Time for finding pairs on one core, ns: linear in the pairs, plus a quadratic term for methods that
/// compare all bodies.
double ns_to_find(const std::string& broad_phase, double bodies, double pairs) {
  const BroadPhaseMethod* method = find_broad_phase(broad_phase);
  const double each = method != nullptr ? method->ns_of_comparison : 0;
  return bodies * ns_of_body + pairs * ns_of_pair + each * bodies * bodies / 2;
}

/// Pipeline runs in a step.
int runs_of(const Physics& physics, int substeps) { return physics.solver == Solver::impulse ? substeps : 1; }

double seconds_of(const Executor& executor, const WorldSetup& setup, const StepEstimate& of) {
  const Physics& physics = setup.scene.physics;
  const int substeps = setup.substeps;
  const double finding = 1e-9 * ns_to_find(setup.broad_phase, static_cast<double>(of.bodies), of.pairs);
  return runs_of(physics, substeps) *
         (finding / executor.equal_cores() +
          estimate_solve_seconds(executor, physics, static_cast<double>(of.bodies), of.contacts, substeps));
}

/// Bytes of all buffers for the estimated numbers of pairs and contacts.
std::int64_t bytes_of(Executor& executor, const WorldSetup& setup, const StepEstimate& of) {
  const auto entries = [](double count, std::int64_t at_first) {
    return std::max(at_first,
                    static_cast<std::int64_t>(std::min(std::ceil(count), static_cast<double>(longest_list))));
  };
  const std::int64_t listed = executor.dry_run_construction([&] {
    const auto pipeline =
        make_pipeline(executor, setup.broad_phase, setup.scene, setup.initial, setup.effects, setup.substeps);
    pipeline->reserve(
        {entries(of.pairs, setup.capacity.pairs), entries(of.contacts, setup.capacity.contacts)});
  });
  // Entries beyond the longest possible list are extrapolated.
  const double beyond = std::max(1.0, of.pairs / static_cast<double>(longest_list));
  return static_cast<std::int64_t>(std::min(static_cast<double>(listed) * beyond, 1e18));
}

std::string in_bytes(double bytes) { return fmt::format("{:.0f} bytes ({})", bytes, short_bytes(bytes)); }

/// Rounds an estimate to three digits.
double rounded(double number) {
  if (number < 1000) return number;
  const double unit = std::pow(10, std::floor(std::log10(number)) - 2);
  return std::round(number / unit) * unit;
}

/// Formats 12345678 as "12,345,678".
std::string in_groups(double number) {
  std::string digits = fmt::format("{:.0f}", number);
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

[[noreturn]] void refuse(const Scene& scene, const std::string& what, double needed, std::int64_t given,
                         const ExecutorOptions& options) {
  const bool limited = options.memory_limit > 0;
  const bool generated = scene.generators.size() == 1;
  const bool paper = generated && scene.generators[0].variant == Variant::paper;
  const double wanted = rounded(needed), there = static_cast<double>(given);
  throw TooLarge(
      fmt::format("{} {}; available: {}, {}; use fewer bodies{}, or {}", what, in_bytes(wanted),
                  in_bytes(there), limited ? "the value of --memory-limit" : "80 % of the free memory",
                  paper ? ", --variant scaled" : "", limited ? "a higher --memory-limit" : "--allow-large"),
      fmt::format("{} {}; available: {}, {}; use fewer bodies{}", what, short_bytes(wanted),
                  short_bytes(there), limited ? "the memory limit" : "80 % of the free memory",
                  paper ? ", or the variant scaled" : ""));
}

std::function<void(const std::string&)>& slow_step_report() {
  static std::function<void(const std::string&)> for_all;
  return for_all;
}

void warn(const Executor& executor, const StepEstimate& expected) {
  if (expected.seconds < long_step || !slow_step_report()) return;
  slow_step_report()(fmt::format("note: a step of {} bodies with about {} pairs will take about {} s on {}",
                                 in_groups(static_cast<double>(expected.bodies)),
                                 in_groups(rounded(expected.pairs)), in_groups(rounded(expected.seconds)),
                                 executor.device_name()));
}

}  // namespace

std::string short_bytes(double bytes) {
  return fmt::format("{:.1f} {}", bytes / (bytes < 1e9 ? 1e6 : 1e9), bytes < 1e9 ? "MB" : "GB");
}

double estimate_solve_seconds(const Executor& executor, const Physics& physics, double bodies,
                              double contacts, int substeps) {
  const int within = substeps / runs_of(physics, substeps);
  return 1e-9 / executor.equal_cores() *
         (bodies * ns_of_body_in_substep * within +
          contacts * (ns_of_contact +
                      within * (ns_of_contact_in_substep + physics.iterations * ns_of_contact_in_sweep)));
}

StepEstimate estimate_step(Executor& executor, const WorldSetup& setup, bool thorough) {
  const MovingSpheres spheres = spheres_of(setup);
  const auto bodies = static_cast<std::int64_t>(setup.initial.size());
  StepEstimate expected;
  expected.bodies = bodies;
  const auto sample = [&](std::int64_t samples) {
    const SampledPairs found = sample_pairs(executor.team(), spheres, samples);
    expected.pairs = found.pairs;
    expected.contacts = found.contacts;
    expected.seconds = seconds_of(executor, setup, expected);
  };
  constexpr std::int64_t few_samples = 64, most_samples = 4000, most_tests = 400'000'000;
  sample(few_samples);
  constexpr double safe = 4;  // safety factor for a small sample
  const double most_bytes =
      static_cast<double>(bodies) * most_bytes_of_body +
      safe * (expected.pairs * most_bytes_of_pair + expected.contacts * most_bytes_of_contact);
  const bool harmless =
      safe * expected.seconds < long_step && most_bytes < static_cast<double>(executor.room_bytes());
  if (harmless && !thorough) return expected;
  sample(std::clamp(most_tests / std::max<std::int64_t>(bodies, 1), few_samples, most_samples));
  expected.bytes = bytes_of(executor, setup, expected);
  return expected;
}

void require_memory_for_step(Executor& executor, const WorldSetup& setup) {
  if (static_cast<std::int64_t>(setup.initial.size()) <= few_bodies) return;
  const StepEstimate expected = estimate_step(executor, setup, false);
  const std::int64_t room = executor.room_bytes();
  const ExecutorOptions& options = executor.options();
  if (expected.bytes > room && !options.allow_large)
    refuse(setup.scene,
           fmt::format("{} bodies have about {} initial pairs and {} initial contacts and need about",
                       in_groups(static_cast<double>(expected.bodies)), in_groups(rounded(expected.pairs)),
                       in_groups(rounded(expected.contacts))),
           static_cast<double>(expected.bytes), room, options);
  warn(executor, expected);
}

void require_memory_for_bodies(const Scene& scene, const RunOptions& options) {
  const std::int64_t bodies = bodies_of(scene);
  if (bodies <= few_bodies || options.allow_large) return;
  // GPU memory is checked in require_memory_for_step().
  const bool limited = options.memory_limit > 0,
             on_gpu = options.executor != ExecutorKind::cpu && cuda_available();
  const std::int64_t room = limited ? options.memory_limit : free_host_bytes() / 5 * 4;
  const std::int64_t each = limited  ? least_bytes_in_buffers
                            : on_gpu ? least_bytes_on_host
                                     : least_bytes_on_host + least_bytes_in_buffers;
  if (bodies <= room / each) return;
  refuse(scene, fmt::format("{} bodies need at least", in_groups(static_cast<double>(bodies))),
         static_cast<double>(each) * static_cast<double>(bodies), room, options);
}

void set_slow_step_callback(std::function<void(const std::string& line)> callback) {
  slow_step_report() = std::move(callback);
}

}  // namespace collidoscope
