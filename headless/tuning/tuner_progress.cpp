#include "headless/tuning/tuner_progress.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "headless/tuning/tuned_run.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/text_file.h"
#include "sim_cuda/tuning/tuned_file.h"
#include "sim_cuda/tuning/tuning_text.h"

namespace collidoscope {
namespace {

using ProgressJson = nlohmann::ordered_json;
constexpr std::size_t most_progress_bytes = std::size_t{256} << 20;

ProgressJson pair_json(const TunerRecord::Pair& pair) {
  ProgressJson stages = ProgressJson::array();
  for (const TunerRecord::StagePair& stage : pair.stages)
    stages.push_back({stage.name, stage.ms, stage.reference_ms, stage.occupancy});
  return {{"ms", pair.ms}, {"reference_ms", pair.reference_ms}, {"stages", stages}};
}

/// A time of a measurement: finite and above 0.
double time_of(const ProgressJson& value) {
  const double ms = value.get<double>();
  if (!std::isfinite(ms) || !(ms > 0)) throw std::range_error("a time must be above 0");
  return ms;
}

TunerRecord::Pair parse_pair(const ProgressJson& json) {
  TunerRecord::Pair pair{time_of(json.at("ms")), time_of(json.at("reference_ms")), {}};
  for (const ProgressJson& stage : json.at("stages"))
    pair.stages.push_back({stage.at(0).get<std::string>(), stage.at(1).get<double>(), time_of(stage.at(2)),
                           stage.at(3).get<double>()});
  return pair;
}

LaunchCell::State parse_state(const std::string& name) {
  for (const auto state :
       {LaunchCell::State::measured, LaunchCell::State::infeasible, LaunchCell::State::wrong})
    if (name == name_of(state)) return state;
  throw std::range_error("unknown state of a cell");
}

TunerRecord parse_progress_record(const ProgressJson& json) {
  using Seconds = std::chrono::duration<double>;
  TunerRecord record{.spent = json.at("seconds").get<double>(), .tasks = {}};
  for (const ProgressJson& one : json.at("tasks")) {
    TunerRecord::Task& task = record.tasks.emplace_back();
    task.cell = one.at("cell").get<std::size_t>();
    task.hurried = one.at("hurried").get<bool>();
    task.state = parse_state(one.at("state").get<std::string>());
    task.reason = one.at("reason").get<std::string>();
    for (const ProgressJson& pair : one.at("pairs")) task.pairs.push_back(parse_pair(pair));
    const ProgressJson& times = one.at("times");
    task.times = {
        times.at(0).get<double>(), times.at(1).get<double>(), times.at(2).get<double>(),
        times.at(3).get<double>(),
        std::chrono::system_clock::time_point(std::chrono::duration_cast<std::chrono::system_clock::duration>(
            Seconds(times.at(4).get<double>())))};
  }
  return record;
}

}  // namespace

ProgressJson search_identity(World& world, int confirmation_pairs) {
  TunedShapes shapes;
  shapes.conditions = world.tuning_conditions();
  return {{"conditions", ProgressJson::parse(write_tuned({shapes}))["results"][0]},
          {"state", world.steps()},
          {"state_hash", fmt::format("{:016x}", world.state_hash())},
          {"reference", shape_text(world.launch_shape())},
          {"stage_shapes", stage_shapes_text(world.options().stage_shapes)},
          {"confirmation_pairs", confirmation_pairs}};
}

ProgressJson progress_json(const ProgressJson& identity, const TunerRecord& record) {
  ProgressJson tasks = ProgressJson::array();
  for (const TunerRecord::Task& task : record.tasks) {
    ProgressJson pairs = ProgressJson::array();
    for (const TunerRecord::Pair& pair : task.pairs) pairs.push_back(pair_json(pair));
    const std::chrono::duration<double> measured_at = task.times.measured_at.time_since_epoch();
    tasks.push_back({{"cell", task.cell},
                     {"hurried", task.hurried},
                     {"state", name_of(task.state)},
                     {"reason", task.reason},
                     {"pairs", pairs},
                     {"times",
                      {task.times.search, task.times.setup, task.times.benchmark, task.times.check,
                       measured_at.count()}}});
  }
  return {{"complete", false}, {"search", identity}, {"seconds", record.spent}, {"tasks", tasks}};
}

void resume_search(const std::string& file, const ProgressJson& identity, LaunchTuner& tuner) {
  if (file.empty() || file == "-" || !std::filesystem::is_regular_file(file)) return;
  TunerRecord record;
  try {
    const ProgressJson json =
        ProgressJson::parse(read_text_file(file, most_progress_bytes, "a report of tune --json"));
    if (json.at("complete").get<bool>()) return;
    if (nlohmann::json(json.at("search")) != nlohmann::json(identity)) {  // the order of members is free
      fmt::print(stderr, "note: {} has the progress of another search, so this one starts again\n", file);
      return;
    }
    record = parse_progress_record(json);
  } catch (const InputError&) {  // cannot be read
    return;
  } catch (const ProgressJson::exception&) {  // no report, or a damaged one
    return;
  } catch (const std::range_error&) {
    return;
  }
  if (tuner.restore(record))
    fmt::print(stderr, "note: {} already has {:.1f} s of measurements\n", file, record.spent);
}

}  // namespace collidoscope
