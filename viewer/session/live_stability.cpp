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

std::string name_of(const TestConfiguration& configuration) {
  return fmt::format("{} {}", name_of(solver_names, configuration.solver),
                     name_of(precision_names, configuration.precision));
}

TestStatus status_of(TestOutcome outcome) {
  switch (outcome) {
    case TestOutcome::passed:
      return TestStatus::passed;
    case TestOutcome::failed:
      return TestStatus::failed;
    case TestOutcome::expected_failure:
      return TestStatus::expected_failure;
    case TestOutcome::not_applicable:
      break;
  }
  return TestStatus::not_applicable;
}

TestRunView with_status(const TestConfiguration& configuration, TestStatus status) {
  TestRunView view;
  view.solver = configuration.solver;
  view.precision = configuration.precision;
  view.status = status;
  return view;
}

TestRunView view_of(const HardCase& hard_case, const TestConfiguration& configuration,
                    const TestResult& result) {
  TestRunView view = with_status(configuration, status_of(result.outcome));
  view.progress = 1;
  view.why = result.why;
  view.failure = result.failure;
  view.steps = result.steps;
  view.seconds = result.seconds;
  for (std::size_t k = 0; k < result.assertions.size(); ++k) {
    const AssertionResult& known = result.assertions[k];
    const Assertion& assertion = hard_case.criterion.assertions[k];
    if (known.measured)
      view.assertions.push_back({text_of(assertion), text_of(assertion.quantity, known.value), known.passed,
                                 known.state, known.body});
  }
  if (result.failed_assertion) {
    view.failed_state = result.assertions[*result.failed_assertion].state;
    view.body = result.assertions[*result.failed_assertion].body;
  }
  return view;
}

}  // namespace

void LiveStability::read() {
  read_ = true;
  try {
    cases_ = read_hard_cases(folder_.empty() ? asset("scenes/hard").string() : folder_);
  } catch (const InputError& error) {
    view_.unavailable_reason = error.lines()[0];
  }
}

void LiveStability::begin_anew(ExecutorKind executor) {
  executor_ = executor;
  queue_.clear();
  test_run_.reset();
  opening_.reset();
  configurations_.clear();
  view_.cases.clear();
  view_.executor = executor == ExecutorKind::cuda ? "CUDA" : "the CPU";
  for (const HardCase& hard_case : cases_) {
    HardCaseView& view = view_.cases.emplace_back();
    view.name = hard_case.name;
    view.what = hard_case.criterion.what;
    view.group = hard_case.criterion.group;
    view.refused = !hard_case.criterion.refused.empty();
    configurations_.push_back(test_configurations(hard_case, executor));
    for (const TestConfiguration& configuration : configurations_.back())
      view.test_runs.push_back(with_status(configuration, TestStatus::not_run));
  }
}

void LiveStability::follow(const World& world, HardCasesRequests& requests) {
  if (!read_) read();
  const ExecutorKind executor = world.info().on_gpu ? ExecutorKind::cuda : ExecutorKind::cpu;
  if (executor != executor_) begin_anew(executor);
  if (std::exchange(requests.stop, false)) stop();
  if (std::exchange(requests.run_all, false)) {
    const bool again = std::ranges::all_of(view_.cases, [](const auto& hard_case) {
      return std::ranges::all_of(hard_case.test_runs, &TestRunView::is_finished);
    });
    for (std::size_t hard_case = 0; hard_case < cases_.size(); ++hard_case) enqueue(hard_case, again);
  }
  if (std::exchange(requests.run_selected, false))
    for (std::size_t hard_case = 0; hard_case < cases_.size(); ++hard_case)
      if (cases_[hard_case].name == requests.selected) enqueue(hard_case, true);
  if (const auto request = std::exchange(requests.open, std::nullopt)) open(*request);
}

void LiveStability::enqueue(std::size_t hard_case, bool again) {
  for (std::size_t k = 0; k < configurations_[hard_case].size(); ++k) {
    TestRunView& view = view_at({hard_case, k});
    const bool in_progress = view.status == TestStatus::waiting || view.status == TestStatus::running;
    if (in_progress || (view.is_finished() && !again)) continue;
    view = with_status(configurations_[hard_case][k], TestStatus::waiting);
    queue_.push_back({hard_case, k});
  }
}

void LiveStability::stop() {
  for (const Place& place : queue_) {
    view_at(place).status = TestStatus::not_run;
    view_at(place).progress = 0;
  }
  queue_.clear();
  test_run_.reset();
  opening_.reset();
}

void LiveStability::open(const HardCasesRequests::Opening& request) {
  const HardCase& hard_case = cases_.at(request.which);
  opening_.reset();
  if (!hard_case.criterion.refused.empty()) return;
  const std::vector<ExecutorKind>& executors = hard_case.criterion.executors;
  if (!executors.empty() && std::ranges::find(executors, executor_) == executors.end())
    throw InputError(fmt::format("the hard case {} is not for {}", hard_case.name, view_.executor));
  TestConfiguration configuration{hard_case.scene.physics.solver, hard_case.scene.physics.precision,
                                  executor_};
  std::int64_t target = 0;
  if (request.test_run) {
    configuration = configurations_[request.which].at(*request.test_run);
    target = view_at({request.which, *request.test_run}).failed_state.value_or(0);
  }
  TestSetup start = make_test_setup(hard_case, configuration, options_);
  LiveWorld::Script script;
  if (!start.changes.empty()) script = {start.scene, start.options, start.changes};
  opening_.emplace(
      Opening{{request.which, request.test_run.value_or(0)},
              request.test_run.has_value(),
              HardCaseSimulation(std::move(start.scene), std::move(start.options), std::move(start.changes)),
              std::move(script),
              target});
}

void LiveStability::advance(double milliseconds) {
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
    const HardCase& hard_case = cases_[place.hard_case];
    const TestConfiguration& configuration = configurations_[place.hard_case][place.test_run];
    if (!test_run_) {
      RunOptions options = options_;
      options.cpu_threads = 1;  // most cases are small
      test_run_.emplace(hard_case, configuration, options);
    }
    if (test_run_->advance(left())) {
      view_at(place).status = TestStatus::running;
      view_at(place).progress = test_run_->progress();
    } else {
      view_at(place) = view_of(hard_case, configuration, test_run_->result());
      test_run_.reset();
      queue_.pop_front();
    }
  }
}

std::optional<LiveStability::Opened> LiveStability::take_opened() {
  if (!opening_ || opening_->run.state() < opening_->target) return std::nullopt;
  Opening opening = std::move(*opening_);
  opening_.reset();
  const HardCaseView& hard_case = view_.cases[opening.place.hard_case];
  Opened opened{std::move(opening.run.world()), std::move(opening.script), false, std::nullopt,
                hard_case.name};
  if (opening.of_test_run) {
    const TestRunView& test_run = view_at(opening.place);
    opened.failed = test_run.failed_state.has_value();
    opened.body = test_run.body;
    opened.notice += ", " + name_of(configurations_[opening.place.hard_case][opening.place.test_run]);
    if (!test_run.failure.empty()) opened.notice += ": " + test_run.failure;
  }
  view_.shown = opening.place.hard_case;
  view_.shown_test_run = opening.of_test_run ? std::optional(opening.place.test_run) : std::nullopt;
  return opened;
}

void LiveStability::case_shown(const std::string& before) { view_.scene_before = before; }

void LiveStability::no_case_shown() {
  view_.scene_before.clear();
  view_.shown.reset();
  view_.shown_test_run.reset();
}

const HardCasesView& LiveStability::view() {
  view_.current_task.clear();
  if (!queue_.empty()) {
    const Place& place = queue_.front();
    view_.current_task = fmt::format("{}, {}", cases_[place.hard_case].name,
                                     name_of(configurations_[place.hard_case][place.test_run]));
  }
  view_.opening.reset();
  if (opening_ && opening_->target > 0)
    view_.opening = static_cast<double>(opening_->run.state()) / static_cast<double>(opening_->target);
  return view_;
}

}  // namespace collidoscope
