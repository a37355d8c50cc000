// Tests invariants on random scenes: determinism, snapshots and energy. COLLIDOSCOPE_RANDOM_SCENES sets their
// number (200). A failing scene is printed as a scene file.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/any_scene.h"
#include "tests/executors.h"
#include "tests/random.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

constexpr int steps = 12;

int scenes() {
  const char* const asked = std::getenv("COLLIDOSCOPE_RANDOM_SCENES");
  return asked != nullptr ? std::atoi(asked) : 200;
}

/// Other run options that must give the same state.
RunOptions another_way(RunOptions options, std::uint32_t seed) {
  Random random(seed);
  const std::vector<std::string> methods = broad_phase_names(options.executor);
  options.broad_phase = methods[random() % methods.size()];
  options.shape = {1 + static_cast<int>(random() % 5), 1 + static_cast<int>(random() % 64)};
  options.cpu_threads = 1 + static_cast<int>(random() % 2);
  options.lane_order = static_cast<LaneOrder>(random() % 3);
  options.initial_pair_capacity = 1 + random() % 8;
  return options;
}

/// Results of a run with `options`, and of one that continues from a snapshot taken halfway.
struct SceneOutcome {
  std::uint64_t hash = 0, hash_from_file = 0;
  StepStats start, end;
};
SceneOutcome run(const Scene& scene, const RunOptions& options, const std::string& file) {
  SceneOutcome result;
  World world(scene, options);
  result.start = world.measure();
  world.step(steps / 2);
  {
    std::ofstream out(file, std::ios::binary);
    write_snapshot(snapshot_of(world), [&](std::string_view bytes) { out << bytes; });
  }
  world.step(steps - steps / 2);
  result.hash = world.state_hash();
  result.end = world.measure();
  const Snapshot half_way = read_snapshot(file);
  World second = world_from(half_way, half_way.scene, options);
  second.step(steps - steps / 2);
  result.hash_from_file = second.state_hash();
  return result;
}

/// The rotation update first_order conserves angular momentum and slowly increases the kinetic energy of a
/// tumbling body. The increase is visible in twelve steps if the rotation per step is large.
bool tumbles_far(const Body& body, const Physics& physics) {
  const double turn = std::sqrt(body.angular_velocity.dot(body.angular_velocity)) * physics.time_step;
  return physics.rotation_update == RotationUpdate::first_order && body.inertia && turn > 0.3;
}

/// Whether the scene has no source of energy: kinematic bodies, tumbling bodies (see above), joints that may
/// start with a wrong length, or attractors.
bool keeps_its_energy(const Scene& scene) {
  for (const std::vector<Body>* list : {&scene.bodies, &scene.extra_bodies})
    for (const Body& body : *list)
      if (body.motion != Motion::dynamic || tumbles_far(body, scene.physics)) return false;
  return scene.joints.empty() && scene.physics.attractors.empty();
}

/// Energy gain relative to the larger kinetic energy plus the change of potential energy.
double energy_gain(const SceneOutcome& run) {
  const double gain = run.end.energy() - run.start.energy() - (run.end.push_work - run.start.push_work);
  const double scale = std::max(run.start.kinetic_energy, run.end.kinetic_energy) +
                       std::abs(run.end.potential_energy - run.start.potential_energy);
  return scale > 0 ? gain / scale : 0;
}

class RandomScenes : public OnEachExecutor {
 protected:
  void check(std::uint32_t seed, Values values) {
    const Scene scene = any_scene(seed, values);
    const std::string text = write_scene(scene);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", the scene:\n" + text);
    ASSERT_EQ(write_scene(parse_scene(text, "any")), text);

    const SceneOutcome straight = run(scene, options(), folder_ / "half-way");
    ASSERT_EQ(straight.hash_from_file, straight.hash) << "a snapshot goes on otherwise";
    const RunOptions other = another_way(options(), seed);
    const SceneOutcome again = run(scene, other, folder_ / "half-way");
    ASSERT_EQ(again.hash, straight.hash)
        << other.broad_phase << ' ' << other.shape.blocks << " x " << other.shape.threads << ", order "
        << static_cast<int>(other.lane_order);
    ASSERT_EQ(again.hash_from_file, straight.hash) << other.broad_phase;
    if (GetParam() != ExecutorKind::cpu) {
      ASSERT_EQ(run(scene, on_cpu(), folder_ / "half-way").hash, straight.hash)
          << "the CPU has another answer";
    }
    if (values == Values::extreme) return;
    ASSERT_EQ(straight.end.non_finite, 0);
    if (keeps_its_energy(scene) && !(straight.start.max_penetration > 0)) {
      ASSERT_LE(energy_gain(straight), 0.05);
    }
  }

  TemporaryFolder folder_;
};
ON_EACH_EXECUTOR(RandomScenes);

TEST_P(RandomScenes, OfOrdinaryThings) {
  for (int seed = 0; seed < scenes() / 2 && !HasFatalFailure(); ++seed)
    check(static_cast<std::uint32_t>(seed), Values::ordinary);
}

TEST_P(RandomScenes, AtTheEndsOfEveryRange) {
  for (int seed = 0; seed < scenes() - scenes() / 2 && !HasFatalFailure(); ++seed)
    check(static_cast<std::uint32_t>(seed), Values::extreme);
}

}  // namespace
}  // namespace collidoscope
