// Tests the search for the fastest launch shape: on invented times with a known optimum, and on worlds.

#include "sim_cuda/tuning/launch_tuner.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

TEST(LaunchAxes, SurroundABlockPerMultiprocessor) {
  const LaunchAxes gpu = launch_axes(132, 50'000);
  EXPECT_THAT(gpu.blocks, testing::ElementsAre(8, 16, 33, 66, 132, 264, 528, 1056));
  EXPECT_THAT(gpu.threads, testing::ElementsAre(32, 64, 128, 256, 512, 1024));
  EXPECT_THAT(launch_axes(0, 100).blocks, testing::ElementsAre(1, 2, 4, 8));
}

/// Invented times of a step, ms, with noise that has outliers.
struct InventedTimes {
  double best_blocks, best_threads;  ///< log2
  double noise;                      ///< relative
  std::mt19937 random{7};

  double exact(LaunchShape shape) const {
    const double b = std::log2(shape.blocks) - best_blocks, t = std::log2(shape.threads) - best_threads;
    // Flat near the best, and steep with too few threads.
    return 1 + 0.02 * b * b + 0.03 * t * t + (b + t < -3 ? 2 * (-3 - b - t) : 0);
  }
  double measured(double ms) {
    std::normal_distribution<double> spread(0, noise);
    std::uniform_real_distribution<double> chance(0, 1);
    return ms * (1 + std::abs(spread(random))) * (chance(random) < 0.05 ? 1.5 : 1);
  }
};

LaunchSearch searched(InventedTimes times, int& pairs) {
  LaunchSearch search({1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024}, {32, 64, 128, 256, 512, 1024}, 32,
                      16384);
  pairs = 0;
  while (const auto task = search.next())
    for (int pair = 0; pair < task->pairs; ++pair, ++pairs)
      search.add(task->cell, times.measured(times.exact(search.cells()[task->cell].shape)),
                 times.measured(1.1));
  return search;
}

/// The best cells differ by less than the noise can resolve, so that a few choices of many exceed 2 %.
TEST(LaunchSearch, FindsTheBestShapeWithin2Percent) {
  constexpr int seeds = 10;
  for (const double noise : {0.001, 0.02, 0.05}) {
    int searches = 0, within = 0;
    for (const double blocks : {3.0, 7.0, 9.6})
      for (const double threads : {6.0, 8.0})
        for (unsigned seed = 0; seed < seeds; ++seed, ++searches) {
          const InventedTimes times{blocks, threads, noise, std::mt19937(seed)};
          int pairs = 0;
          const LaunchSearch search = searched(times, pairs);
          const std::size_t chosen = search.chosen().value();
          const double time = times.exact(search.cells()[chosen].shape);
          within += time < 1.02 + noise / 4 ? 1 : 0;
          EXPECT_LT(time, 1.02 + noise / 2) << blocks << ' ' << threads << ' ' << noise << ' ' << seed;
          // All 66 cells with the pairs of the finalists would be 66 * 62.
          EXPECT_LT(pairs, 66 * 62 / 4);
          const RatioEstimate confirmed = search.confirmation();
          EXPECT_EQ(confirmed.pairs, LaunchSearch::fresh_pairs);
          EXPECT_LT(confirmed.high, 1) << "at least 7 % faster than the reference";
          EXPECT_THAT(search.plateau(), testing::Contains(chosen));
        }
    EXPECT_GE(within, 0.95 * searches) << noise;
  }
}

TEST(LaunchSearch, LeavesOutShapesWithFewThreads) {
  int pairs = 0;
  const LaunchSearch search = searched({9, 8, 0.01}, pairs);
  const auto one = std::ranges::find(search.cells(), LaunchShape{1, 32}, &LaunchCell::shape);
  EXPECT_EQ(one->state, LaunchCell::State::left_out);
  EXPECT_TRUE(one->ratios.empty());
  EXPECT_THAT(one->reason, testing::HasSubstr("much slower"));
}

TEST(LaunchSearch, EndsWithoutAFeasibleShape) {
  LaunchSearch search({1, 2}, {32}, 32, 64);
  while (const auto task = search.next()) search.exclude(task->cell, LaunchCell::State::infeasible, "no");
  EXPECT_FALSE(search.chosen());
  EXPECT_TRUE(search.plateau().empty());
}

TEST(LaunchSearch, ConfirmsTheBestSoFarIfTimeIsShort) {
  LaunchSearch search({1, 2, 4}, {32}, 32, 128);
  for (int k = 0; k < 2; ++k) {
    const auto task = search.next();
    for (int pair = 0; pair < task->pairs; ++pair) search.add(task->cell, k == 0 ? 2 : 1, 1);
  }
  search.hurry();
  const auto task = search.next();
  ASSERT_TRUE(task);
  EXPECT_TRUE(search.confirming());
  EXPECT_EQ(search.cells()[task->cell].shape, (LaunchShape{2, 32}));
  for (int pair = 0; pair < task->pairs; ++pair) search.add(task->cell, 1, 2);
  EXPECT_FALSE(search.next());
  EXPECT_EQ(search.confirmation().ratio, 0.5);
  EXPECT_EQ(search.cells()[task->cell].ratios.size(), 2u) << "the confirmation has fresh pairs";
}

class LaunchTuners : public OnEachExecutor {};
ON_EACH_EXECUTOR(LaunchTuners);

Scene tuned_scene() {
  Scene scene = box_collider(300);
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.3;
  return scene;
}

/// Seconds that suffice to measure all shapes of a small scene, also on a busy machine.
constexpr double enough_seconds = 60;

Scene small_scene() {
  Scene scene = tuned_scene();
  scene.generators[0].count = 20;
  return scene;
}

/// A pause of the machine may lengthen a measurement, so the bound on the time is ten times the budget.
TEST_P(LaunchTuners, KeepTheirBudget) {
  World world(tuned_scene(), options());
  LaunchTuner tuner(world, 0.5);
  while (!tuner.done()) tuner.advance(50);
  EXPECT_LT(tuner.spent(), 5);
}

TEST_P(LaunchTuners, MeasureAllShapes) {
  World world(small_scene(), options());
  world.step(10);
  const std::uint64_t hash = world.state_hash();
  LaunchTuner tuner(world, enough_seconds);
  while (!tuner.done()) tuner.advance(50);
  ASSERT_TRUE(tuner.search().chosen());
  EXPECT_GT(tuner.search().confirmation().pairs, 5);
  int measured = 0;
  for (const LaunchCell& cell : tuner.search().cells()) {
    measured += cell.state == LaunchCell::State::measured;
    EXPECT_NE(cell.state, LaunchCell::State::wrong) << cell.reason;
  }
  EXPECT_GT(measured, 4);
  EXPECT_GT(tuner.reference_ms(), 0);
  const std::vector<LaunchTuner::Stage> stages = tuner.stages();
  const auto solve = std::ranges::find(stages, "solve", &LaunchTuner::Stage::name);
  ASSERT_NE(solve, stages.end());
  EXPECT_TRUE(solve->obeys);
  EXPECT_GT(solve->reference_ms, 0);
  EXPECT_GT(solve->cell_ms[*tuner.search().chosen()], 0);
  EXPECT_EQ(world.state_hash(), hash) << "the run is only read";
  EXPECT_EQ(world.launch_shape(), LaunchShape{});
}

/// A shape that leads to another state is reported, and never chosen.
TEST_P(LaunchTuners, ReportAnotherHash) {
  World world(small_scene(), options());
  LaunchTuner tuner(world, enough_seconds);
  tuner.set_hash([](World& one) { return one.state_hash() ^ (one.launch_shape().threads == 64 ? 1u : 0u); });
  while (!tuner.done()) tuner.advance(50);
  int wrong = 0;
  for (const LaunchCell& cell : tuner.search().cells()) {
    if (cell.state != LaunchCell::State::wrong) continue;
    ++wrong;
    EXPECT_EQ(cell.shape.threads, 64);
    EXPECT_THAT(cell.reason, testing::HasSubstr("expected"));
  }
  EXPECT_GT(wrong, 0);
  ASSERT_TRUE(tuner.search().chosen());
  EXPECT_NE(tuner.search().cells()[*tuner.search().chosen()].shape.threads, 64);
}

/// A measurement that is cancelled is made again, so the map is as complete as without cancellation.
TEST_P(LaunchTuners, GoOnAfterCancellation) {
  Cancellation cancellation;
  RunOptions cancellable = options();
  cancellable.cancellation = &cancellation;
  Scene scene = box_collider(20);
  scene.physics.solver = Solver::soft_step;
  World world(scene, cancellable);
  world.step(5);
  LaunchTuner tuner(world, enough_seconds);
  // Each cancellation comes a tenth later than the one before, so that every measurement ends at last.
  double polls = 0, next = 20;
  int cancelled = 0;
  cancellation.set_poll(
      [&] {
        if (++polls < next) return;
        polls = 0;
        next *= 1.1;
        cancellation.request_between_steps();
      },
      std::chrono::milliseconds(0));
  while (!tuner.done()) try {
      tuner.advance(50);
    } catch (const Cancelled&) {
      ++cancelled;
      cancellation.clear();
    }
  EXPECT_GT(cancelled, 10);
  EXPECT_GE(tuner.search().confirmation().pairs, LaunchSearch::fresh_pairs)
      << "those before a cancellation count, too";
  for (const LaunchCell& cell : tuner.search().cells()) {
    EXPECT_NE(cell.state, LaunchCell::State::waiting);
    EXPECT_NE(cell.state, LaunchCell::State::wrong) << cell.reason;
    if (cell.state == LaunchCell::State::measured) {
      EXPECT_GE(cell.ratios.size(), LaunchSearch::first_pairs);
    }
  }
}

/// A search that goes on from the record of another process knows all that the first one knew.
TEST_P(LaunchTuners, GoOnFromARecord) {
  Scene scene = box_collider(20);
  scene.physics.solver = Solver::soft_step;
  World world(scene, options());
  world.step(5);
  LaunchTuner first(world, enough_seconds);
  for (int measurements = 0; measurements < 40; ++measurements) first.advance(0);
  const TunerRecord record = first.record();
  ASSERT_EQ(record.tasks.size(), 40u);

  LaunchTuner second(world, enough_seconds);
  ASSERT_TRUE(second.restore(record));
  EXPECT_EQ(second.spent(), first.spent());
  EXPECT_EQ(second.reference_ms(), first.reference_ms());
  ASSERT_EQ(second.search().cells().size(), first.search().cells().size());
  for (std::size_t k = 0; k < first.search().cells().size(); ++k) {
    EXPECT_EQ(second.search().cells()[k].state, first.search().cells()[k].state);
    EXPECT_EQ(second.search().cells()[k].ratios, first.search().cells()[k].ratios);
  }
  const std::vector<LaunchTuner::Stage> stages = first.stages(), restored = second.stages();
  ASSERT_EQ(restored.size(), stages.size());
  for (std::size_t k = 0; k < stages.size(); ++k) {
    EXPECT_EQ(restored[k].name, stages[k].name);
    EXPECT_EQ(restored[k].obeys, stages[k].obeys);
    EXPECT_EQ(restored[k].reference_ms, stages[k].reference_ms);
    EXPECT_THAT(restored[k].cell_ms, testing::Pointwise(testing::NanSensitiveDoubleEq(), stages[k].cell_ms));
  }
  EXPECT_EQ(second.cell_times().size(), first.cell_times().size());
  while (!second.done()) second.advance(50);
  EXPECT_TRUE(second.search().chosen());
  EXPECT_GE(second.search().confirmation().pairs, LaunchSearch::fresh_pairs);

  // A record of another search changes nothing.
  TunerRecord other = record;
  std::swap(other.tasks[3].cell, other.tasks[4].cell);
  LaunchTuner third(world, enough_seconds);
  EXPECT_FALSE(third.restore(other));
  EXPECT_EQ(third.spent(), 0);
  for (const LaunchCell& cell : third.search().cells()) EXPECT_EQ(cell.state, LaunchCell::State::waiting);
}

TEST_P(LaunchTuners, MeasureTheBestShapeOfEachStage) {
  World world(small_scene(), options());
  LaunchTuner tuner(world, enough_seconds);
  while (!tuner.done()) tuner.advance(50);
  const StageShapes shapes = tuner.stage_shapes();
  if (shapes.empty()) return;  // auto is the best of all
  EXPECT_GT(tuner.stage_confirmation().pairs, 5);
  World tuned(small_scene(), options());
  tuned.set_stage_shapes(shapes);
  tuned.step(12);
  world.step(12);
  EXPECT_EQ(tuned.state_hash(), world.state_hash());
}

TEST_P(LaunchTuners, ShapesOfStagesKeepTheState) {
  World plain(tuned_scene(), options());
  RunOptions shaped = options();
  shaped.stage_shapes = {{"solve", {3, 32}}, {"pairs", {1, 64}}, {"relax", {0, 32}}, {"bounce", {7, 0}}};
  World world(tuned_scene(), shaped);
  plain.step(20);
  world.step(20);
  EXPECT_EQ(world.state_hash(), plain.state_hash());
  const auto launch = [](const World& one, std::string_view stage) {
    const std::vector<StageTime> stages = one.times().stages;
    return std::ranges::find(stages, stage, &StageTime::name)->launch;
  };
  EXPECT_EQ(launch(world, "bounds").blocks, launch(plain, "bounds").blocks);
  EXPECT_NE(launch(world, "pairs").blocks, launch(plain, "pairs").blocks);
  // They stay when the shape of all others changes.
  world.set_launch_shape({2, 32});
  world.step(2);
  plain.step(2);
  EXPECT_EQ(world.state_hash(), plain.state_hash());
  EXPECT_EQ(world.options().stage_shapes.size(), 4u);

  EXPECT_THROW(
      {
        world.set_stage_shapes({{"solv", {1, 32}}});
        world.step();
      },
      InputError);
  World misspelt(tuned_scene(), [&] {
    RunOptions wrong = options();
    wrong.stage_shapes = {{"solv", {1, 32}}};
    return wrong;
  }());
  EXPECT_THAT([&] { misspelt.step(); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("solv: not a stage"), testing::HasSubstr("solve"))));
}

}  // namespace
}  // namespace collidoscope
