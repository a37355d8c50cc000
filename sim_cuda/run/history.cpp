#include "sim_cuda/run/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sim_cuda/core/finite_or_null.h"
#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/statistics.h"
#include "sim_cuda/measure/launch_json.h"

namespace collidoscope {

void History::add(HistoryStep step, const std::vector<StageTime>& stages) {
  step.stage_ms.clear();
  for (const StageTime& time : stages) {
    const auto known = std::ranges::find(stages_, time.name, &Stage::name);
    const auto place = static_cast<std::size_t>(known - stages_.begin());
    if (known == stages_.end()) stages_.emplace_back().name = time.name;
    stages_[place].launches = time.launches;
    stages_[place].library_launch = time.library_launch;
    stages_[place].launch = time.launch;
    if (step.stage_ms.size() <= place) step.stage_ms.resize(place + 1, -1.0f);
    step.stage_ms[place] = static_cast<float>(time.last_ms);
  }
  auto shared = std::make_shared<const HistoryStep>(std::move(step));
  if (steps_.size() < capacity_) {
    steps_.push_back(std::move(shared));
    return;
  }
  steps_[first_] = std::move(shared);
  first_ = (first_ + 1) % capacity_;
}

void History::clear() {
  steps_.clear();
  stages_.clear();
  first_ = 0;
}

void History::forget_after(std::int64_t step) {
  std::rotate(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(first_), steps_.end());
  first_ = 0;
  std::erase_if(steps_, [&](const auto& entry) { return entry->step > step; });
}

bool History::current(std::size_t stage) const {
  for (std::size_t i = size(); i-- > 0;) {
    const std::vector<float>& times = (*this)[i].stage_ms;
    if (!times.empty()) return stage < times.size() && times[stage] >= 0;
  }
  return false;
}

template <class Value>
TimeSummary History::summarize(std::size_t window, Value value) const {
  std::vector<float> samples;
  TimeSummary summary;
  const std::size_t from = size() - std::min(window, size());
  for (std::size_t i = from; i < size(); ++i) {
    const double ms = value((*this)[i]);
    if (ms < 0) continue;
    samples.push_back(static_cast<float>(ms));
    summary.now = ms;
  }
  summary.samples = static_cast<int>(samples.size());
  summary.median = quantile(samples, 0.5);
  summary.p95 = quantile(std::move(samples), 0.95);
  return summary;
}

TimeSummary History::summarize_stage(std::size_t stage, std::size_t window) const {
  return summarize(window, [stage](const HistoryStep& s) {
    return stage < s.stage_ms.size() ? static_cast<double>(s.stage_ms[stage]) : -1.0;
  });
}

TimeSummary History::summarize_plain(std::size_t window) const {
  return summarize(window, [](const HistoryStep& s) { return s.plain_ms; });
}

TimeSummary History::summarize_sum(std::size_t window) const {
  return summarize(window, [](const HistoryStep& s) { return s.stage_sum(); });
}

std::string history_csv(const History& history, std::size_t window) {
  std::string text =
      "step,step_ms,stage_sum_ms,bodies,pairs,touching,speculative,nodes,allocated_bytes,kinetic,potential,"
      "push_work,"
      "momentum_x,momentum_y,momentum_z,max_penetration,escaped,asleep,islands";
  for (const History::Stage& stage : history.stages()) text += "," + stage.name + "_ms";
  text += '\n';
  const auto time = [](double ms) { return ms < 0 ? std::string() : fmt::format("{}", ms); };
  for (std::size_t i = history.size() - std::min(window, history.size()); i < history.size(); ++i) {
    const HistoryStep& s = history[i];
    text += fmt::format("{},{},{},", s.step, time(s.plain_ms), time(s.stage_sum()));
    if (s.measured)
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", s.stats.bodies, s.stats.pairs,
                          s.stats.touching, s.stats.speculative, s.nodes, s.allocated_bytes,
                          s.stats.kinetic_energy, s.stats.potential_energy, s.stats.push_work,
                          s.stats.momentum[0], s.stats.momentum[1], s.stats.momentum[2],
                          s.stats.max_penetration, s.stats.escaped,
                          s.stats.can_sleep ? fmt::format("{},{}", s.stats.asleep, s.stats.islands) : ",");
    else
      text += fmt::format(",,,,{},{},,,,,,,,,,", s.nodes, s.allocated_bytes);
    for (std::size_t k = 0; k < history.stages().size(); ++k)
      text += "," + (k < s.stage_ms.size() ? time(static_cast<double>(s.stage_ms[k])) : std::string());
    text += '\n';
  }
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

Json time_or_null(double ms) { return ms < 0 ? Json(nullptr) : finite_or_null(ms); }

Json summary(const TimeSummary& times) {
  if (times.samples == 0) return {{"median_ms", nullptr}, {"p95_ms", nullptr}, {"samples", 0}};
  return {{"median_ms", times.median}, {"p95_ms", times.p95}, {"samples", times.samples}};
}

}  // namespace

std::string history_json(const History& history, std::size_t window) {
  Json document = Json::object();
  document["step"] = summary(history.summarize_plain(window));
  document["stage_sum"] = summary(history.summarize_sum(window));
  document["stages"] = Json::array();
  for (std::size_t k = 0; k < history.stages().size(); ++k) {
    const History::Stage& stage = history.stages()[k];
    Json entry = {{"name", stage.name},
                  {"launches", stage.launches},
                  {"library_launch", stage.library_launch},
                  {"launch", launch_json(stage.launch)}};
    entry.update(summary(history.summarize_stage(k, window)));
    document["stages"].push_back(entry);
  }
  document["steps"] = Json::array();
  for (std::size_t i = history.size() - std::min(window, history.size()); i < history.size(); ++i) {
    const HistoryStep& s = history[i];
    Json entry = {{"step", s.step},
                  {"step_ms", time_or_null(s.plain_ms)},
                  {"nodes", s.nodes},
                  {"allocated_bytes", s.allocated_bytes}};
    Json stages = Json::object();
    for (std::size_t k = 0; k < s.stage_ms.size(); ++k)
      stages[history.stages()[k].name] = time_or_null(static_cast<double>(s.stage_ms[k]));
    entry["stage_ms"] = s.instrumented() ? stages : Json(nullptr);
    if (s.measured) {
      entry["bodies"] = s.stats.bodies;
      entry["pairs"] = s.stats.pairs;
      entry["touching"] = s.stats.touching;
      entry["speculative"] = s.stats.speculative;
      entry["kinetic"] = finite_or_null(s.stats.kinetic_energy);
      entry["potential"] = finite_or_null(s.stats.potential_energy);
      entry["push_work"] = finite_or_null(s.stats.push_work);
      entry["momentum"] = {finite_or_null(s.stats.momentum[0]), finite_or_null(s.stats.momentum[1]),
                           finite_or_null(s.stats.momentum[2])};
      entry["max_penetration"] = finite_or_null(s.stats.max_penetration);
      entry["escaped"] = s.stats.escaped;
      if (s.stats.can_sleep) {
        entry["asleep"] = s.stats.asleep;
        entry["islands"] = s.stats.islands;
      }
    }
    document["steps"].push_back(entry);
  }
  return document.dump(1) + '\n';
}

}  // namespace collidoscope
