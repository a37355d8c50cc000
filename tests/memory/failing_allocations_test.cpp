// Tests an allocation failure at each allocation in turn. The operation must end with an error message, free
// its memory, and leave existing data unchanged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "headless/cli/command_line.h"
#include "headless/cli/exit_status.h"
#include "headless/run.h"
#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/mesh.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/memory/counted_new.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::Contains;
using testing::HasSubstr;

struct Refusals {
  std::int64_t allocations = 0;  ///< by the work
  std::set<std::string> said;
};

/// Repeats `work`, each time with a later allocation failing, until no allocation fails.
Refusals refuse_each(Refusal refusal, const std::function<void()>& work, std::int64_t stride = 1) {
  Refusals refusals;
  work();  // initialises static data
  for (bool refused = true; refused; refusals.allocations += stride) {
    char said[200] = "";
    const std::int64_t before = counted_new().live_bytes;
    {
      const RefusedNew refuse(refusals.allocations, refusal);
      try {
        work();
      } catch (const std::bad_alloc& error) {
        std::strncpy(said, error.what(), sizeof said - 1);
      } catch (const MachineError& error) {
        std::strncpy(said, error.what(), sizeof said - 1);
      }
      refused = refuse.refused();
    }
    EXPECT_EQ(counted_new().live_bytes, before)
        << "a leak, or less, after " << refusals.allocations << " allocations";
    if (*said != 0) refusals.said.insert(said);
  }
  return refusals;
}

constexpr Refusal both[] = {Refusal::once, Refusal::from_then_on};

std::string read_text(const std::string& name) { return text_of(project_file("assets/scenes/" + name)); }

RunOptions one_thread() {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  options.cpu_threads = 1;
  return options;
}

/// More and more spheres fall on each other.
Scene rain(Solver solver) {
  Scene scene = box_collider(60);
  scene.physics.solver = solver;
  if (solver != Solver::impulse) scene.materials[0].friction = 0.5;
  scene.generators[0].radius_max = 12;
  scene.generators[0].speed_max = 30;
  scene.physics.sleep = solver == Solver::soft_step ? std::optional(Sleep{}) : std::nullopt;
  return scene;
}

TEST(FailingAllocations, OfReaders) {
  const std::string scene = read_text("marble_run.json"), half = scene.substr(0, scene.size() / 2);
  const std::string mesh = read_text("meshes/l_block.obj");
  const Scene changed = box_collider(20);
  const std::string changes = R"({"format": "collidoscope-changes", "version": 1, "changes": [
    {"step": 2, "bodies": 10}, {"step": 3, "remove": [1], "add": [{"position": [1, 2, 3]}]}]})";
  for (const Refusal refusal : both) {
    EXPECT_THAT(refuse_each(refusal, [&] { write_scene(parse_scene(scene, "f")); }).said,
                Contains("reading a scene"));
    const auto read_half = [&] {
      try {
        parse_scene(half, "f");
      } catch (const InputError&) {
      }
    };
    EXPECT_THAT(refuse_each(refusal, read_half).said, Contains("reading a scene"));
    EXPECT_THAT(refuse_each(refusal, [&] { parse_mesh(mesh, "f", "m"); }).said, Contains("reading a mesh"));
    EXPECT_THAT(
        refuse_each(refusal, [&] { write_changes(parse_changes(changes, "f", changed, {}, 0), changed); })
            .said,
        Contains("reading a list of changes"));
  }
}

TEST(FailingAllocations, OfSnapshots) {
  const TemporaryFolder folder;
  World world(rain(Solver::soft_step), one_thread());
  world.step(5);
  {
    std::ofstream out(folder / "s", std::ios::binary);
    write_snapshot(snapshot_of(world), [&](std::string_view bytes) { out << bytes; });
  }
  const std::string file = folder / "s";
  for (const Refusal refusal : both) {
    EXPECT_THAT(refuse_each(refusal, [&] { read_snapshot(file); }).said, Contains("reading a snapshot"));
    refuse_each(refusal, [&] {
      std::size_t bytes = 0;
      write_snapshot(snapshot_of(world), [&](std::string_view more) { bytes += more.size(); });
    });
  }
}

TEST(FailingAllocations, OfWorlds) {
  for (const Solver solver : {Solver::impulse, Solver::soft_step, Solver::jacobi_split})
    for (const Refusal refusal : both) {
      const Scene scene = rain(solver);
      const Refusals refusals = refuse_each(refusal, [&] { World(scene, one_thread()).step(2); });
      EXPECT_GT(refusals.allocations, 50);
      EXPECT_THAT(refusals.said, Contains("creating a world"));
    }
}

/// Includes growing lists. After a failure the world continues bit for bit like one without a failure.
TEST(FailingAllocations, OfSteps) {
  for (const Solver solver : {Solver::impulse, Solver::soft_step, Solver::jacobi_split}) {
    const Scene scene = rain(solver);
    RunOptions options = one_thread();
    options.initial_pair_capacity = 4;
    World undisturbed(scene, options);
    undisturbed.step(6);
    const std::uint64_t hash = undisturbed.state_hash();
    for (const Refusal refusal : both) {
      int lost = 0, went_on = 0;
      std::set<std::string> said;
      for (std::int64_t granted = 0; granted < 10'000; ++granted) {
        World world(scene, options);
        char words[200] = "";
        bool refused = false;
        {
          const RefusedNew refuse(granted, refusal);
          try {
            world.step(5);
            world.measure();
          } catch (const std::bad_alloc& error) {
            std::strncpy(words, error.what(), sizeof words - 1);
          } catch (const MachineError& error) {
            std::strncpy(words, error.what(), sizeof words - 1);
          }
          refused = refuse.refused();
        }
        said.insert(words);
        try {
          while (world.steps() < 6) world.step();
          ASSERT_EQ(world.state_hash(), hash) << granted << " granted, then: " << words;
          ++went_on;
        } catch (const MachineError& error) {
          ASSERT_THAT(error.what(), HasSubstr("no valid state to continue from"));
          ++lost;
        }
        if (!refused) break;
      }
      EXPECT_GT(went_on, 20);
      EXPECT_THAT(said, Contains("computing a step"));
      EXPECT_LT(lost, went_on) << "most refusals are not within a step";
    }
  }
}

/// With the address sanitizer a process needs ten times as long, so only every tenth allocation fails.
#ifdef WITH_SANITIZER
constexpr int stride = 10;
#else
constexpr int stride = 1;
#endif

TEST(FailingAllocations, OfTheProgram) {
  const TemporaryFolder folder;
  const std::vector<std::string> names{"json", "bodies", "snapshot"};
  CommandLine line = parse_command_line({"run", "box_collider", "--executor", "cpu", "--bodies", "30",
                                         "--steps", "2", "--json", folder / "json", "--dump-bodies",
                                         folder / "bodies", "--save", folder / "snapshot"});
  line.options.run.cpu_threads = 1;
  for (const std::string& name : names) std::ofstream(folder / name) << "old";
  const auto files = [&] { return std::distance(std::filesystem::directory_iterator(folder.path()), {}); };
  const std::string errors = folder / "errors";

  for (const Refusal refusal : both) {
    int failures = 0;
    for (std::int64_t granted = 0;; granted += stride) {
      const pid_t child = fork();  // a library may end the program, so it runs in a child process
      ASSERT_GE(child, 0);
      if (child == 0) {
        install_out_of_memory_handler();
        if (std::freopen("/dev/null", "w", stdout) == nullptr ||
            std::freopen(errors.c_str(), "w", stderr) == nullptr)
          _exit(126);
        std::setvbuf(stderr, nullptr, _IONBF, 0);
        const RefusedNew refuse(granted, refusal);
        const int status = run_and_report_errors([&] { return run_command(line); });
        _exit(status == 0 && refuse.refused() ? 77 : status);
      }
      int ended = 0;
      ASSERT_EQ(waitpid(child, &ended, 0), child);
      ASSERT_TRUE(WIFEXITED(ended)) << "signal " << WTERMSIG(ended) << " after " << granted << " allocations";
      const int status = WEXITSTATUS(ended);
      const std::string said = text_of(errors);
      ASSERT_LE(files(), 7) << "what is left piles up: " << said;
      for (const std::string& name : names) {
        const std::string text = text_of(folder / name);
        ASSERT_TRUE(text == "old" || text.size() > 500) << name << " is cut short: " << said;
      }
      if (status == 0) break;
      if (status == 77) continue;  // no allocation failed, or its failure was handled
      ++failures;
      ASSERT_EQ(status, missing_resource) << said;
      ASSERT_TRUE(said.ends_with('\n') && std::count(said.begin(), said.end(), '\n') == 1) << said;
      ASSERT_THAT(said, HasSubstr("out of memory")) << granted;
    }
    EXPECT_GT(failures, 300 / stride);
    EXPECT_EQ(files(), 4) << "the last run, which had all its memory, took over what the others left";
  }
}

}  // namespace
}  // namespace collidoscope
