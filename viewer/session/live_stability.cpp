#include "viewer/session/live_stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

std::string name_of(const TrialSetting& setting) {
  return fmt::format("{} {}", name_of(solver_names, setting.solver),
                     name_of(precision_names, setting.precision));
}

HardMark mark_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return HardMark::passed;
    case Verdict::failed:
      return HardMark::failed;
    case Verdict::declared_limit:
      return HardMark::declared_limit;
    case Verdict::not_applicable:
      break;
  }
  return HardMark::not_applicable;
}

HardTrialFacts marked(const TrialSetting& setting, HardMark mark) {
  HardTrialFacts facts;
  facts.solver = setting.solver;
  facts.precision = setting.precision;
  facts.mark = mark;
  return facts;
}

HardTrialFacts facts_of(const HardCase& one, const TrialSetting& setting, const TrialResult& result) {
  HardTrialFacts facts = marked(setting, mark_of(result.verdict));
  facts.progress = 1;
  facts.why = result.why;
  facts.failure = result.failure;
  facts.steps = result.steps;
  facts.seconds = result.seconds;
  for (std::size_t k = 0; k < result.terms.size(); ++k) {
    const TermResult& known = result.terms[k];
    const Term& term = one.criterion.holds[k];
    if (known.measured)
      facts.terms.push_back(
          {text_of(term), text_of(term.quantity, known.value), known.held, known.state, known.body});
  }
  if (result.failed_term) {
    facts.failed_state = result.terms[*result.failed_term].state;
    facts.body = result.terms[*result.failed_term].body;
  }
  return facts;
}

}  // namespace

void LiveStability::read() {
  read_ = true;
  try {
    cases_ = read_hard_cases(folder_.empty() ? asset("scenes/hard").string() : folder_);
  } catch (const InputError& error) {
    facts_.lack = error.lines()[0];
  }
}

void LiveStability::begin_anew(ExecutorKind executor) {
  executor_ = executor;
  queue_.clear();
  trial_.reset();
  opening_.reset();
  settings_.clear();
  facts_.cases.clear();
  facts_.executor = executor == ExecutorKind::cuda ? "CUDA" : "the CPU";
  for (const HardCase& one : cases_) {
    HardCaseFacts& facts = facts_.cases.emplace_back();
    facts.name = one.name;
    facts.what = one.criterion.what;
    facts.group = one.criterion.group;
    facts.refused = !one.criterion.refused.empty();
    settings_.push_back(trials_of(one, executor));
    for (const TrialSetting& setting : settings_.back())
      facts.trials.push_back(marked(setting, HardMark::not_run));
  }
}

void LiveStability::follow(const World& world, HardCasesWishes& wishes) {
  if (!read_) read();
  const ExecutorKind executor = world.info().on_gpu ? ExecutorKind::cuda : ExecutorKind::cpu;
  if (executor != executor_) begin_anew(executor);
  if (std::exchange(wishes.stop, false)) stop();
  if (std::exchange(wishes.run_all, false)) {
    const bool again = std::ranges::all_of(
        facts_.cases, [](const auto& one) { return std::ranges::all_of(one.trials, &HardTrialFacts::over); });
    for (std::size_t one = 0; one < cases_.size(); ++one) enqueue(one, again);
  }
  if (std::exchange(wishes.run_selected, false))
    for (std::size_t one = 0; one < cases_.size(); ++one)
      if (cases_[one].name == wishes.selected) enqueue(one, true);
  if (const auto wish = std::exchange(wishes.open, std::nullopt)) open(*wish);
}

void LiveStability::enqueue(std::size_t one, bool again) {
  for (std::size_t k = 0; k < settings_[one].size(); ++k) {
    HardTrialFacts& facts = facts_at({one, k});
    const bool under_way = facts.mark == HardMark::waiting || facts.mark == HardMark::running;
    if (under_way || (facts.over() && !again)) continue;
    facts = marked(settings_[one][k], HardMark::waiting);
    queue_.push_back({one, k});
  }
}

void LiveStability::stop() {
  for (const Place& place : queue_) {
    facts_at(place).mark = HardMark::not_run;
    facts_at(place).progress = 0;
  }
  queue_.clear();
  trial_.reset();
  opening_.reset();
}

void LiveStability::open(const HardCasesWishes::Opening& wish) {
  const HardCase& one = cases_.at(wish.which);
  opening_.reset();
  if (!one.criterion.refused.empty()) return;
  const std::vector<ExecutorKind>& executors = one.criterion.executors;
  if (!executors.empty() && std::ranges::find(executors, executor_) == executors.end())
    throw InputError(fmt::format("the hard case {} is not for {}", one.name, facts_.executor));
  TrialSetting setting{one.scene.physics.solver, one.scene.physics.precision, executor_};
  std::int64_t target = 0;
  if (wish.trial) {
    setting = settings_[wish.which].at(*wish.trial);
    target = facts_at({wish.which, *wish.trial}).failed_state.value_or(0);
  }
  TrialStart start = start_of(one, setting, options_);
  LiveWorld::Script script;
  if (!start.changes.empty()) script = {start.scene, start.options, start.changes};
  opening_.emplace(
      Opening{{wish.which, wish.trial.value_or(0)},
              wish.trial.has_value(),
              HardRun(std::move(start.scene), std::move(start.options), std::move(start.changes)),
              std::move(script),
              target});
}

void LiveStability::go_on(double milliseconds) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto left = [&] {
    return milliseconds - std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  };
  while (opening_ && opening_->run.state() < opening_->target && left() > 0) try {
      opening_->run.step();
    } catch (...) {
      opening_.reset();
      throw;
    }
  while (!queue_.empty() && left() > 0) {
    const Place place = queue_.front();
    const HardCase& one = cases_[place.one];
    const TrialSetting& setting = settings_[place.one][place.trial];
    if (!trial_) {
      RunOptions options = options_;
      options.cpu_threads = 1;  // most cases are small
      trial_.emplace(one, setting, options);
    }
    if (trial_->go_on(left())) {
      facts_at(place).mark = HardMark::running;
      facts_at(place).progress = trial_->progress();
    } else {
      facts_at(place) = facts_of(one, setting, trial_->result());
      trial_.reset();
      queue_.pop_front();
    }
  }
}

std::optional<LiveStability::Opened> LiveStability::take_opened() {
  if (!opening_ || opening_->run.state() < opening_->target) return std::nullopt;
  Opening opening = std::move(*opening_);
  opening_.reset();
  const HardCaseFacts& one = facts_.cases[opening.place.one];
  Opened opened{std::move(opening.run.world()), std::move(opening.script), false, std::nullopt, one.name};
  if (opening.any_trial) {
    const HardTrialFacts& trial = facts_at(opening.place);
    opened.failed = trial.failed_state.has_value();
    opened.body = trial.body;
    opened.notice += ", " + name_of(settings_[opening.place.one][opening.place.trial]);
    if (!trial.failure.empty()) opened.notice += ": " + trial.failure;
  }
  facts_.shown = opening.place.one;
  facts_.shown_trial = opening.any_trial ? std::optional(opening.place.trial) : std::nullopt;
  return opened;
}

void LiveStability::shows_case(const std::string& before) { facts_.before = before; }

void LiveStability::shows_none() {
  facts_.before.clear();
  facts_.shown.reset();
  facts_.shown_trial.reset();
}

const HardCasesFacts& LiveStability::facts() {
  facts_.doing.clear();
  if (!queue_.empty()) {
    const Place& place = queue_.front();
    facts_.doing = fmt::format("{}, {}", cases_[place.one].name, name_of(settings_[place.one][place.trial]));
  }
  facts_.opening.reset();
  if (opening_ && opening_->target > 0)
    facts_.opening = static_cast<double>(opening_->run.state()) / static_cast<double>(opening_->target);
  return facts_;
}

}  // namespace collidoscope
