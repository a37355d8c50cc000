#include "sim_cuda/changes/change_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/broad_phase/methods.h"
#include "sim_cuda/scene/body_reader.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

void read_substeps(Reading& reading, ObjectReader& reader, Change& change) {
  const JsonNode* node = reader.member("substeps");
  if (node == nullptr) return;
  if (node->kind == JsonKind::text && reading.document.text(*node) == "auto")
    change.substeps = std::optional<int>{};
  else if (int substeps = 0; reader.whole("substeps", substeps))
    change.substeps = substeps;
}

void read_shape(Reading& reading, ObjectReader& reader, std::string_view key, int most,
                std::optional<int>& value) {
  const JsonNode* node = reader.member(key);
  if (node == nullptr) return;
  int count = 0;
  if (node->kind == JsonKind::text && reading.document.text(*node) == "auto") {
    value = 0;
  } else if (reader.whole(key, count)) {
    if (count < 1 || count > most)
      reading.fault(*node, fmt::format("\"{}\" is \"auto\" or a whole number from 1 to {}", key, most));
    value = count;
  }
}

}  // namespace

void read_settings(Reading& reading, ObjectReader& reader, Change& change) {
  const auto whole = [&](std::string_view key, auto& value) {
    if (typename std::remove_reference_t<decltype(value)>::value_type read{}; reader.whole(key, read))
      value = read;
  };
  const auto real = [&](std::string_view key, std::optional<double>& value) {
    if (double read = 0; reader.real(key, read)) value = read;
  };
  const auto choice = [&](std::string_view key, const auto& table, auto& value) {
    typename std::remove_reference_t<decltype(value)>::value_type read{};
    if (reader.choice(key, table, read)) value = read;
  };
  whole("bodies", change.bodies);
  real("radius_max", change.radius_max);
  whole("seed", change.seed);
  choice("variant", variant_names, change.variant);
  real("time_step", change.time_step);
  whole("steps_per_second", change.steps_per_second);
  if (change.time_step && change.steps_per_second)
    reading.fault_at_key(*reader.member("steps_per_second"),
                         "time_step and steps_per_second are both given; keep one of them");
  read_substeps(reading, reader, change);
  whole("iterations", change.iterations);
  real("restitution", change.restitution);
  choice("solver", solver_names, change.solver);
  choice("integrator", integrator_names, change.integrator);
  choice("rotation_update", rotation_update_names, change.rotation_update);
  choice("precision", precision_names, change.precision);
  if (const JsonNode* node = reader.member("effects")) {
    std::optional<Effects> effects;
    read_effects(reading, *node, effects);
    change.effects = effects;
  }
}

void read_run_options(Reading& reading, ObjectReader& reader, Change& change) {
  read_shape(reading, reader, "blocks", limits::max_blocks, change.blocks);
  read_shape(reading, reader, "threads", limits::max_threads, change.threads);
  std::string name;
  if (!reader.text("broad_phase", name)) return;
  const std::vector<std::string> known = broad_phase_names();
  if (std::ranges::find(known, name) == known.end())
    reading.fault(
        *reader.member("broad_phase"),
        unknown_name("broad phase", name, std::vector<std::string_view>(known.begin(), known.end())));
  change.broad_phase = name;
}

}  // namespace collidoscope
