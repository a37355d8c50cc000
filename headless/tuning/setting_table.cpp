#include "headless/tuning/setting_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "headless/reporting/percentiles_json.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string error_text(double error) { return std::isfinite(error) ? fmt::format("{:.3g}", error) : "-"; }

}  // namespace

Json settings_json(World& world, const SettingComparison& comparison) {
  const WorldInfo info = world.info();
  Json report{{"scene", world.scene().name},
              {"bodies", world.initial().size()},
              {"state", world.steps()},
              {"device", info.device_name},
              {"broad_phase", world.options().broad_phase},
              {"plugins", plugin_notes(world.options().check_pairs)},
              {"physics_version", physics_version},
              {"reference",
               {{"ms", number_or_null(comparison.reference_ms)},
                {"error", number_or_null(comparison.reference_error)}}},
              {"error_resolution", number_or_null(comparison.error_resolution)},
              {"seconds", comparison.seconds},
              {"settings", Json::array()}};
  if (!comparison.error_unavailable.empty()) report["error_unavailable"] = comparison.error_unavailable;
  for (const ComparedSetting& row : comparison.rows) {
    Json one{{"setting", row.axis}, {"value", row.value}, {"keeps_result", row.keeps_result}};
    if (!row.unavailable_reason.empty()) one["unavailable"] = row.unavailable_reason;
    if (!row.difference.empty()) one["difference"] = row.difference;
    if (row.estimate.pairs > 0) {
      one["ms"] = row.ms;
      one["ratio"] = estimate_json(row.estimate);
    }
    if (!row.keeps_result) one["error"] = number_or_null(row.error);
    report["settings"].push_back(std::move(one));
  }
  return report;
}

std::string settings_text(World& world, const SettingComparison& comparison) {
  const bool with_errors = !std::ranges::all_of(comparison.rows, &ComparedSetting::keeps_result);
  std::string text = fmt::format("{}, {} bodies, state {}, on {}\n\n{:<14}{:<18}{:>12}", world.scene().name,
                                 world.initial().size(), world.steps(), world.info().device_name, "setting",
                                 "value", "ms per step");
  text += with_errors ? fmt::format("{:>12}\n", "error, m") : "\n";
  const auto line = [&](std::string_view axis, std::string_view value, double ms, double error,
                        std::string_view said) {
    text +=
        fmt::format("{:<14}{:<18}{:>12}", axis, value, std::isfinite(ms) ? fmt::format("{:.3f}", ms) : "-");
    if (with_errors) text += fmt::format("{:>12}", error_text(error));
    text += said.empty() ? "\n" : fmt::format("  {}\n", said);
  };
  line("(current)", "", comparison.reference_ms, comparison.reference_error, "");
  for (const ComparedSetting& row : comparison.rows)
    line(row.axis, row.value, row.ms, row.error,
         !row.unavailable_reason.empty() ? row.unavailable_reason
         : !row.difference.empty()       ? "WRONG: " + row.difference
                                         : verdict(row.estimate, "current"));
  if (with_errors && std::isfinite(comparison.error_resolution))
    text += fmt::format("\nerror: r.m.s. distance to a reference run; below {:.3g} m it means nothing\n",
                        comparison.error_resolution);
  if (!comparison.error_unavailable.empty()) text += comparison.error_unavailable + '\n';
  return text + fmt::format("{:.1f} s\n", comparison.seconds);
}

}  // namespace collidoscope
