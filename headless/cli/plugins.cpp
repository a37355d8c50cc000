#include "headless/cli/plugins.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "headless/cli/flag_value.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/plugin/library.h"
#include "sim_cuda/plugin/validation.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_lines = 5;

void load(std::string& method, const char* flag, int gpu) try {
  if (!is_plugin_path(method)) return;
  ValidationOptions how;
  how.gpu = gpu;
  const PluginValidation validation = validate_plugin(full_plugin_path(method), how);
  if (!validation.ended.empty())
    throw InputError(fmt::format("{}: {}, expected a plug-in that passes collidoscope-headless validate",
                                 validation.path, validation.ended));
  const std::vector<std::string> faults = validation.faults();
  for (std::size_t k = 0; k < std::min(faults.size(), most_lines); ++k)
    fmt::print(stderr, "{}: {}\n", validation.path, faults[k]);
  method = load_plugin(validation.path, validation.identity, !faults.empty());
  if (faults.empty())
    fmt::print(stderr, "note: {}: broad phase {}, {} tests passed\n", validation.path, method,
               validation.tests.size());
  else
    fmt::print(stderr,
               "note: {}: broad phase {}, {} of {} tests failed; its pairs are compared in each step\n",
               validation.path, method, faults.size(), validation.tests.size());
} catch (const InputError& error) {
  throw InputError(fmt::format("{}: {}", flag, error.what()));
}

}  // namespace

void load_plugins(Options& options) {
  load(options.run.broad_phase, "--broad-phase", options.run.gpu);
  for (std::string& method : options.bench.methods) load(method, "--methods", options.run.gpu);
  if (options.run.check_pairs == PairComparison::off) return;
  std::vector<std::string> methods = options.bench.methods;
  methods.push_back(options.run.broad_phase);
  if (std::ranges::none_of(methods, is_plugin))
    throw InputError(fmt::format("--check-pairs: {} is built in, expected --broad-phase with a plug-in",
                                 options.run.broad_phase));
}

}  // namespace collidoscope
