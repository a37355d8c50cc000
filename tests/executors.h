#pragma once
// The executors of this machine, for tests that run once per executor: on the CPU, and on CUDA if a GPU is
// present.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "sim_cuda/world.h"

namespace collidoscope {

inline std::vector<ExecutorKind> executors() {
  std::vector<ExecutorKind> kinds{ExecutorKind::cpu};
  if (cuda_available()) kinds.push_back(ExecutorKind::cuda);
  return kinds;
}

/// `threads`: number of threads; 0 for all of the machine.
inline RunOptions on_cpu(int threads = 0) {
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  options.cpu_threads = threads;
  return options;
}

inline std::string executor_name(const testing::TestParamInfo<ExecutorKind>& info) {
  return info.param == ExecutorKind::cuda ? "cuda" : "cpu";
}

/// A fixture whose tests run once per executor.
class OnEachExecutor : public testing::TestWithParam<ExecutorKind> {
 protected:
  RunOptions options() const {
    RunOptions o;
    o.executor = GetParam();
    return o;
  }
};

/// Launches per step, by stage, after `steps` steps. On the CPU, stages of many rounds are left out, since
/// only rounds with items count, which depends on the contacts.
inline std::map<std::string, int> launches_by_stage(World& world, int steps = 10) {
  world.step(steps);
  std::map<std::string, int> launches;
  for (const StageTime& stage : world.times().stages) launches[stage.name] = stage.launches;
  if (!world.info().on_gpu)
    for (const char* name : {"bounce", "colour", "solve", "relax"}) launches.erase(name);
  return launches;
}

#define ON_EACH_EXECUTOR(Fixture) \
  INSTANTIATE_TEST_SUITE_P(Executors, Fixture, testing::ValuesIn(executors()), executor_name)

}  // namespace collidoscope
