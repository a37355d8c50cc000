// Tests determinism: scene, seed and physical settings determine the state bit for bit, at every launch
// shape, on every executor. Golden hashes of a dozen scenes are committed, so that machines with and without
// a GPU check each other's results.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "sim_cuda/run/published_records.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/names.h"
#include "tests/executors.h"
#include "tests/golden_files.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

constexpr int golden_steps = 60;

/// With a sanitizer, tests are up to 30 times slower. Any shape with several lanes and threads shows a race
/// or a wrong index.
#ifdef WITH_SANITIZER
const std::vector<LaunchShape> launch_shapes{{2, 4}, {0, 0}};
const std::vector<LaneOrder> lane_orders{LaneOrder::shuffled};
const std::vector<int> thread_counts{2};
const std::vector<std::pair<Precision, Integrator>> integrators{
    {Precision::f32, Integrator::semi_implicit_euler}, {Precision::f64, Integrator::rk4}};
constexpr int steps_per_shape = 20, steps_per_method = 4, balls_each_way = 12;
#else
const std::vector<LaunchShape> launch_shapes{{1, 1}, {2, 4}, {16, 16}, {8, 64}, {3, 37}, {0, 0}};
const std::vector<LaneOrder> lane_orders{LaneOrder::contiguous, LaneOrder::strided, LaneOrder::shuffled};
const std::vector<int> thread_counts{1, 2};
const std::vector<std::pair<Precision, Integrator>> integrators{
    {Precision::f32, Integrator::semi_implicit_euler},
    {Precision::f64, Integrator::semi_implicit_euler},
    {Precision::f32, Integrator::velocity_verlet},
    {Precision::f64, Integrator::rk4}};
constexpr int steps_per_shape = 40, steps_per_method = 30, balls_each_way = 30;
#endif

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string hash_after(const Scene& scene, const RunOptions& options, int steps) {
  World world(scene, options);
  world.step(steps);
  return hex(world.state_hash());
}

class OneAnswer : public OnEachExecutor {};
ON_EACH_EXECUTOR(OneAnswer);

TEST_P(OneAnswer, AtEveryLaunchShapeLaneOrderAndThreadCount) {
  for (int kind = 0; kind < 4; ++kind) {
    Scene scene = box_collider(700);  // 700 is no multiple of any B x T
    scene.generators[0].radius_max = 7;
    scene.physics.precision = kind % 2 ? Precision::f64 : Precision::f32;
    scene.physics.solver = kind < 2 ? Solver::impulse : Solver::soft_step;
    const std::string expected = hash_after(scene, options(), steps_per_shape);
    for (const LaunchShape shape : launch_shapes)
      for (const LaneOrder order : lane_orders)
        for (const int threads : thread_counts) {
          if (GetParam() == ExecutorKind::cuda && (order != lane_orders.front() || threads != 1)) continue;
          RunOptions o = options();
          o.shape = shape;
          o.lane_order = order;
          o.cpu_threads = threads;
          EXPECT_EQ(hash_after(scene, o, steps_per_shape), expected)
              << shape.blocks << " x " << shape.threads << ", order " << static_cast<int>(order) << ", "
              << threads;
        }
  }
}

TEST_P(OneAnswer, OfEveryEffectAtEveryLaunchShape) {
  for (const char* name :
       {"rolling", "rolling_out", "sinking", "orbits", "carousel", "wrecking_ball", "marble_run"})
    for (const auto& [precision, integrator] : integrators) {
      Scene scene = project_scene(name);
      scene.physics.precision = precision;
      scene.physics.integrator = integrator;
      const std::string expected = hash_after(scene, options(), steps_per_shape);
      for (const LaunchShape shape : launch_shapes)
        for (const LaneOrder order : lane_orders) {
          if (GetParam() == ExecutorKind::cuda && order != lane_orders.front()) continue;
          RunOptions o = options();
          o.shape = shape;
          o.lane_order = order;
          o.cpu_threads = 2;
          EXPECT_EQ(hash_after(scene, o, steps_per_shape), expected)
              << name << ' ' << shape.blocks << " x " << shape.threads << ", order "
              << static_cast<int>(order);
        }
    }
}

TEST_P(OneAnswer, WithEveryBroadPhaseAndKeySize) {
  std::vector<Scene> scenes{project_scene("giant_among_dust"), project_scene("all_coincident"),
                            project_scene("mixed_materials"), project_scene("slope"), box_collider(900)};
  for (std::size_t k = 5; k-- > 0;) {
    scenes.push_back(scenes[k]);
    scenes.back().physics.solver = Solver::soft_step;
  }
  for (const Scene& scene : scenes) {
    const std::string expected = hash_after(scene, options(), steps_per_method);
    for (const std::string& method : broad_phase_names(GetParam()))
      for (const int bits : {30, 63}) {
        RunOptions o = options();
        o.broad_phase = method;
        o.key_bits = bits;
        EXPECT_EQ(hash_after(scene, o, steps_per_method), expected)
            << scene.name << ' ' << method << ' ' << bits;
      }
  }
}

TEST_P(OneAnswer, WithEverySortAtEveryLaunchShape) {
  const Scene scene = box_collider(700);
  const std::string expected = hash_after(scene, options(), 30);
  for (const SortMethod sort : {SortMethod::automatic, SortMethod::library, SortMethod::radix})
    for (const char* method : {"lbvh_ropes", "bvh_bottom_up", "lbvh_top_down"}) {
      RunOptions o = options();
      o.broad_phase = method;
      o.sort = sort;
      World world(scene, o);
      // (B, T) may change during a run. The sort's table must be large enough for all shapes.
      for (const LaunchShape shape : {LaunchShape{2, 4}, {16, 16}, {64, 1024}}) {
        world.set_launch_shape(shape);
        world.step(10);
      }
      EXPECT_EQ(hex(world.state_hash()), expected) << method << ' ' << static_cast<int>(sort);
    }
}

// On a GPU, the threads of a block share the work of one body with many contacts.
TEST_P(OneAnswer, OfOneWhoTouchesThousands) {
  Scene scene;
  scene.physics.gravity = Vector3d::Zero();
  const double radius = 50;
  const auto ball = [](double r, const Vector3d& at, const Vector3d& velocity) {
    Body body;
    body.radius = r;
    body.position = at;
    body.velocity = velocity;
    return body;
  };
  for (int i = -balls_each_way; i < balls_each_way; ++i)
    for (int j = -balls_each_way; j < balls_each_way; ++j) {
      const double r = 0.3 + 0.01 * ((7 * i + 13 * j) % 10), away = radius + 0.99 * r;
      scene.bodies.push_back(ball(r, {1.0 * i, 1.0 * j, std::sqrt(away * away - i * i - j * j)},
                                  {0.1 * (i % 3), 0.1 * (j % 4), -1}));
    }
  RunOptions on_cpu;
  on_cpu.executor = ExecutorKind::cpu;
  for (const bool first : {false, true}) {
    scene.bodies.insert(first ? scene.bodies.begin() : scene.bodies.end(),
                        ball(radius, Vector3d::Zero(), Vector3d::Zero()));
    for (const Solver solver : {Solver::impulse, Solver::soft_step, Solver::jacobi_split})
      for (const Precision precision : {Precision::f32, Precision::f64}) {
        scene.physics.solver = solver;
        scene.physics.precision = precision;
        scene.materials[0].friction = solver == Solver::impulse ? 0 : 0.5;
        World expected(scene, on_cpu);
        expected.step();
        EXPECT_GT(expected.measure().uncoloured_contacts, 3 * balls_each_way * balls_each_way);
        expected.step(5);
        for (const LaunchShape shape : {LaunchShape{0, 0}, {3, 37}, {40, 16}}) {
          RunOptions o = options();
          o.shape = shape;
          EXPECT_EQ(hash_after(scene, o, 6), hex(expected.state_hash()))
              << name_of(solver_names, solver) << ' ' << shape.blocks << ' ' << shape.threads;
        }
      }
    if (!first) scene.bodies.pop_back();
  }
}

class OneAnswerOfASolver : public testing::TestWithParam<std::tuple<ExecutorKind, Solver>> {
 protected:
  RunOptions options() const {
    RunOptions o;
    o.executor = std::get<0>(GetParam());
    return o;
  }
};
std::string executor_and_solver(const testing::TestParamInfo<std::tuple<ExecutorKind, Solver>>& each) {
  const auto [kind, solver] = each.param;
  return std::string(kind == ExecutorKind::cuda ? "cuda_" : "cpu_") +
         std::string(name_of(solver_names, solver));
}
INSTANTIATE_TEST_SUITE_P(Executors, OneAnswerOfASolver,
                         testing::Combine(testing::ValuesIn(executors()),
                                          testing::Values(Solver::impulse, Solver::soft_step)),
                         executor_and_solver);

TEST_P(OneAnswerOfASolver, WithCapacitiesTenTimesTooSmall) {
  Scene scene = box_collider(1000);
  scene.physics.solver = std::get<1>(GetParam());
  scene.physics.substeps = 3;  // so that lists also overflow within a step
  World roomy(scene, options());
  roomy.step(30);
  const std::int64_t pairs = roomy.measure().pairs;
  ASSERT_GT(pairs, 500);
  RunOptions o = options();
  for (const std::int64_t capacity : {std::int64_t{1}, pairs / 10, pairs - 1}) {
    o.initial_pair_capacity = capacity;
    World tight(scene, o);
    tight.step(30);
    EXPECT_EQ(tight.state_hash(), roomy.state_hash()) << capacity;
    EXPECT_EQ(tight.measure().pairs, pairs);
    EXPECT_EQ(tight.measure().touching, roomy.measure().touching);
    EXPECT_EQ(tight.measure().speculative, roomy.measure().speculative);
  }
}

TEST_P(OneAnswerOfASolver, DetectingMeasuringAndPublishingChangeNothing) {
  Scene scene = box_collider(500);
  scene.physics.solver = std::get<1>(GetParam());
  World plain(scene, options()), watched(scene, options());
  plain.step(20);
  PublishedRecords records;
  for (int k = 0; k < 20; ++k) {
    watched.step();
    watched.detect();
    watched.measure();
    FrameLayers layers;
    layers.spheres = layers.boxes = layers.contacts = true;
    layers.color = BodyColor::contacts;
    watched.publisher().copy(layers, records);
  }
  EXPECT_EQ(watched.state_hash(), plain.state_hash());
}

/// One entry of tests/golden/hashes.json.
struct GoldenRun {
  std::string scene, key;
  Precision precision;
  Solver solver;
  std::optional<Integrator> integrator;  ///< empty: the scene's own
};

std::vector<GoldenRun> golden_runs() {
  // These scenes also run with impulse, independent of the default solver.
  const std::vector<std::string> with_impulse{"box_collider",
                                              "box_collider_equal",
                                              "box_collider_scaled",
                                              "two_spheres_head_on",
                                              "two_spheres_oblique",
                                              "free_flight",
                                              "bouncing_ball",
                                              "spinning_top",
                                              "newtons_cradle",
                                              "all_coincident",
                                              "on_a_line",
                                              "giant_among_dust",
                                              "gas",
                                              "slope",
                                              "tumbling_mesh",
                                              "mixed_materials",
                                              "one_body",
                                              "empty"};
  // These scenes have effects that impulse lacks.
  const std::vector<std::string> soft_step_only{"rolling", "rolling_out", "sinking",
                                                "orbits",  "carousel",    "marble_run"};
  std::vector<GoldenRun> runs;
  for (const std::string& scene : with_impulse) {
    runs.push_back({scene, "f32", Precision::f32, Solver::impulse, {}});
    runs.push_back({scene, "f64", Precision::f64, Solver::impulse, {}});
  }
  for (const auto* scenes : {&with_impulse, &soft_step_only})
    for (const std::string& scene : *scenes) {
      runs.push_back({scene, "soft_step f32", Precision::f32, Solver::soft_step, {}});
      runs.push_back({scene, "soft_step f64", Precision::f64, Solver::soft_step, {}});
      runs.push_back({scene, "soft_step f32 velocity_verlet", Precision::f32, Solver::soft_step,
                      Integrator::velocity_verlet});
      runs.push_back({scene, "soft_step f64 rk4", Precision::f64, Solver::soft_step, Integrator::rk4});
    }
  return runs;
}

nlohmann::ordered_json golden_hashes() {
  std::ifstream in(golden_file<"hashes.json">());
  return in ? nlohmann::ordered_json::parse(in) : nlohmann::ordered_json::object();
}

TEST_P(OneAnswer, OfTheGoldenScenes) {
  nlohmann::ordered_json golden = golden_hashes();
  const bool update = std::getenv("UPDATE_GOLDENS") != nullptr && GetParam() == ExecutorKind::cpu;
  for (const GoldenRun& run : golden_runs()) {
    Scene scene = project_scene(run.scene);
    scene.physics.precision = run.precision;
    scene.physics.solver = run.solver;
    if (run.integrator) scene.physics.integrator = *run.integrator;
    const std::string hash = hash_after(scene, options(), golden_steps);
    if (update)
      golden[run.scene][run.key] = hash;
    else
      EXPECT_EQ(golden.value(run.scene, nlohmann::ordered_json::object()).value(run.key, "none"), hash)
          << run.scene << ' ' << run.key;
  }
  if (update) std::ofstream(golden_file<"hashes.json">()) << golden.dump(2) << '\n';
}

TEST(GoldenHashes, EachIsReadByATest) {
  std::set<std::pair<std::string, std::string>> in_file, read;
  const nlohmann::ordered_json golden = golden_hashes();
  for (const auto& [scene, hashes] : golden.items())
    for (const auto& [key, hash] : hashes.items()) in_file.emplace(scene, key);
  for (const GoldenRun& run : golden_runs())
    EXPECT_TRUE(read.emplace(run.scene, run.key).second) << run.scene << ' ' << run.key << " is there twice";
  std::vector<std::pair<std::string, std::string>> unread, missing;
  std::ranges::set_difference(in_file, read, std::back_inserter(unread));
  std::ranges::set_difference(read, in_file, std::back_inserter(missing));
  EXPECT_THAT(unread, testing::IsEmpty());
  EXPECT_THAT(missing, testing::IsEmpty());
}

TEST(StateHash, SeesEveryComponentOfEveryBody) {
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  Scene scene = empty_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(1, 2, 3)), sphere(1, Vector3d(10, 0, 0))};
  scene.bodies[0].angular_velocity = Vector3d(0.1, 0.2, 0.3);
  const std::uint64_t hash = World(scene, o).state_hash();
  for (int body = 0; body < 2; ++body)
    for (int axis = 0; axis < 3; ++axis) {
      Scene other = scene;
      other.bodies[static_cast<std::size_t>(body)].position[axis] += 1e-6;
      EXPECT_NE(World(other, o).state_hash(), hash);
      other = scene;
      other.bodies[static_cast<std::size_t>(body)].velocity[axis] += 1e-6;
      EXPECT_NE(World(other, o).state_hash(), hash);
      other = scene;
      other.bodies[static_cast<std::size_t>(body)].angular_velocity[axis] += 1e-6;
      EXPECT_NE(World(other, o).state_hash(), hash);
    }
  Scene swapped = scene;
  std::swap(swapped.bodies[0], swapped.bodies[1]);
  EXPECT_NE(World(swapped, o).state_hash(), hash) << "ids matter";
  Scene zero = scene;
  zero.bodies[1].velocity = Vector3d(-0.0, 0, 0);
  EXPECT_EQ(World(zero, o).state_hash(), hash) << "-0 is 0";
}

}  // namespace
}  // namespace collidoscope
