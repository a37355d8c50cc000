// Tests that memory does not grow with the number of steps, nor with the worlds created and destroyed.
// COLLIDOSCOPE_SMALL_STEPS sets the number of steps (100,000; with a sanitizer 3,000). A run may last for
// days.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "sim_cuda/core/parallel_for.h"
#include "sim_cuda/world.h"
#include "tests/memory/counted_new.h"
#include "tests/scenes.h"

#ifdef WITH_SANITIZER
// The address sanitizer quarantines up to 256 MiB of freed memory, which would look like growth.
extern "C" const char* __asan_default_options() { return "quarantine_size_mb=1"; }
#endif

namespace collidoscope {
namespace {

#ifdef WITH_SANITIZER  // steps take about ten times as long
constexpr std::int64_t default_steps = 3000;
#else
constexpr std::int64_t default_steps = 100'000;
#endif

/// Resident memory of this process in bytes.
std::int64_t resident_bytes() {
  std::int64_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

TEST(SteadyMemory, OfSmallSteps) {
  const char* const asked = std::getenv("COLLIDOSCOPE_SMALL_STEPS");
  const std::int64_t steps = asked != nullptr ? std::atoll(asked) : default_steps;
  for (const Solver solver : {Solver::impulse, Solver::soft_step, Solver::jacobi_split}) {
    Scene scene = box_collider(3);
    scene.physics.solver = solver;
    scene.box = Box{Vector3d(0, 0, 0), Vector3d(12, 12, 12)};
    scene.physics.time_step = 0.001;
    scene.materials[0].restitution = 1;
    RunOptions options;
    options.executor = ExecutorKind::cpu;
    options.cpu_threads = 1;
    World world(scene, options);
    const auto go_to = [&](std::int64_t state) {
      while (world.steps() < state) {
        world.step(static_cast<int>(std::min<std::int64_t>(1000, state - world.steps())));
        world.measure();
        world.times();
      }
    };
    go_to(20'000);  // the history of step times is full
    const std::int64_t taken = counted_new().live_bytes, resident = resident_bytes();
    go_to(20'000 + steps / 3);
    EXPECT_EQ(counted_new().live_bytes, taken);
    EXPECT_LE(resident_bytes(), resident + (std::int64_t{1} << 20));
  }
}

TEST(SteadyMemory, OfTeamsOfThreadsThatComeAndGo) {
  std::vector<ThreadTeam::KeyedIndex> records(2000);
  const auto sort_by_new_teams = [&](int times) {
    for (int k = 0; k < times; ++k) {
      for (std::uint32_t i = 0; i < records.size(); ++i) records[i] = {i * 7919u % 1009u, i};
      ThreadTeam(2).sort(records.data(), std::ssize(records));
    }
  };
  sort_by_new_teams(100);
  const std::int64_t resident = resident_bytes();
  sort_by_new_teams(4000);
  EXPECT_LE(resident_bytes(), resident + (std::int64_t{1} << 20));
}

}  // namespace
}  // namespace collidoscope
