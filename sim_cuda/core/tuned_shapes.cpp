#include "sim_cuda/core/tuned_shapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "sim_cuda/core/physics_version.h"

#if SIM_CUDA
#include <cuda_runtime_api.h>
#endif

namespace collidoscope {
namespace {

/// Largest ratio of the numbers of bodies.
constexpr std::int64_t size_factor = 2;

struct ConditionCheck {
  int equal = 0;          // conditions that are equal, in the order below, before the first other one
  std::string rejection;  // of the first other one
};

ConditionCheck compare_conditions(const TuningConditions& then, const TuningConditions& now) {
  ConditionCheck check;
  const auto compare = [&](const char* what, const auto& a, const auto& b) {
    if (!check.rejection.empty()) return;
    if (a == b)
      ++check.equal;
    else
      check.rejection = fmt::format("{} was {}, is {}", what, a, b);
  };
  const auto text = [](const std::string& value) { return value.empty() ? std::string("none") : value; };
  compare("device", then.device, now.device);
  compare("driver", text(then.driver), text(now.driver));
  compare("build", then.build, now.build);
  compare("number of CPU threads", then.cpu_threads, now.cpu_threads);
  compare("broad phase", then.broad_phase, now.broad_phase);
  compare("solver", then.solver, now.solver);
  compare("precision", then.precision, now.precision);
  compare("list of effects", text(fmt::format("{}", fmt::join(then.effects, ", "))),
          text(fmt::format("{}", fmt::join(now.effects, ", "))));
  if (!check.rejection.empty()) return check;
  const auto [fewer, more] = std::minmax(then.bodies, now.bodies);
  if (more > size_factor * fewer)
    check.rejection = fmt::format("number of bodies was {}, is {}", then.bodies, now.bodies);
  return check;
}

}  // namespace

std::string tuned_text(const TunedShapes& result) {
  return fmt::format("{} with {} bodies: {}", result.conditions.scene, result.conditions.bodies,
                     verdict(result.ratio, "plain auto"));
}

TunedChoice choose_tuned(const std::vector<TunedShapes>& results, const TuningConditions& now) {
  TunedChoice choice;
  int most_equal = -1;
  const auto is_faster = [](const TunedShapes& result) { return result.ratio.high < 1; };
  // The least is the best. Of two equally near ones, that which keeps plain auto.
  const auto rank = [&](const TunedShapes& result) {
    const auto [fewer, more] = std::minmax(result.conditions.bodies, now.bodies);
    return std::tuple(result.conditions.scene != now.scene,
                      static_cast<double>(more) / static_cast<double>(fewer), is_faster(result));
  };
  for (const TunedShapes& result : results) {
    ConditionCheck check = compare_conditions(result.conditions, now);
    if (check.rejection.empty()) {
      if (choice.used == nullptr || rank(result) < rank(*choice.used)) choice.used = &result;
    } else if (check.equal > most_equal && (check.equal > 0 || result.named_by_user)) {
      most_equal = check.equal;
      choice.rejection = std::move(check.rejection);
    }
  }
  if (choice.used == nullptr) return choice;
  if (is_faster(*choice.used)) return {choice.used, ""};
  return {nullptr, tuned_text(*choice.used)};
}

std::string build_name(bool on_gpu) {
#if SIM_CUDA
  if (on_gpu)
    return fmt::format("nvcc {}.{}, physics {}", CUDART_VERSION / 1000, CUDART_VERSION % 1000 / 10,
                       physics_version);
#endif
  static_cast<void>(on_gpu);
#ifdef __clang__
  return fmt::format("clang {}, physics {}", __clang_major__, physics_version);
#else
  return fmt::format("g++ {}, physics {}", __GNUC__, physics_version);
#endif
}

}  // namespace collidoscope
