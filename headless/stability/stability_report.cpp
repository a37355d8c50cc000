#include "headless/stability/stability_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/reporting/report.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(ExecutorKind executor) { return executor == ExecutorKind::cuda ? "cuda" : "cpu"; }

template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of(const Assertion& assertion, const AssertionResult& result) {
  return {{"term", text_of(assertion)},
          {"quantity", collidoscope::name_of(quantity_names, assertion.quantity)},
          {"measured", result.measured},
          {"held", result.passed},
          {"worst", result.measured ? Json(result.worst()) : Json(nullptr)},
          {"bound", result.measured ? Json(result.bound) : Json(nullptr)},
          {"state", result.state},
          {"body", or_null(result.body)}};
}

Json json_of(const TestRow& row) {
  const TestResult& result = row.result;
  const bool refused = !row.hard_case->criterion.refused.empty();
  Json assertions = Json::array();
  for (std::size_t k = 0; k < result.assertions.size() && !refused; ++k)
    assertions.push_back(json_of(row.hard_case->criterion.assertions[k], result.assertions[k]));
  const AssertionResult* failed =
      result.failed_assertion ? &result.assertions[*result.failed_assertion] : nullptr;
  return {
      {"case", row.hard_case->name},
      {"group", row.hard_case->criterion.group},
      {"solver",
       refused ? Json(nullptr) : Json(collidoscope::name_of(solver_names, row.configuration.solver))},
      {"precision",
       refused ? Json(nullptr) : Json(collidoscope::name_of(precision_names, row.configuration.precision))},
      {"executor", name_of(row.configuration.executor)},
      {"verdict", collidoscope::name_of(test_outcome_names, result.outcome)},
      {"why", result.why},
      {"failure", result.failure},
      {"failing_state", failed ? Json(failed->state) : Json(nullptr)},
      {"failing_body", failed ? or_null(failed->body) : Json(nullptr)},
      {"terms", std::move(assertions)},
      {"steps", result.steps},
      {"state_hash", result.state_hash ? Json(fmt::format("{:016x}", *result.state_hash)) : Json(nullptr)},
      {"seconds", result.seconds}};
}

Json json_of(const Criterion& criterion, const ExpectedFailure& limit) {
  Json fails = Json::array();
  for (const ExpectedFailureTerm& term : limit.fails)
    fails.push_back(text_of(criterion.assertions[term.assertion], term));
  return {{"solver", limit.solver ? Json(collidoscope::name_of(solver_names, *limit.solver)) : Json(nullptr)},
          {"precision",
           limit.precision ? Json(collidoscope::name_of(precision_names, *limit.precision)) : Json(nullptr)},
          {"executor", limit.executor ? Json(name_of(*limit.executor)) : Json(nullptr)},
          {"fails", std::move(fails)},
          {"why", limit.why}};
}

Json json_of(const HardCase& hard_case) {
  Json limits = Json::array();
  for (const ExpectedFailure& limit : hard_case.criterion.expected_failures)
    limits.push_back(json_of(hard_case.criterion, limit));
  return {{"name", hard_case.name},
          {"group", hard_case.criterion.group},
          {"what", hard_case.criterion.what},
          {"limits", std::move(limits)}};
}

const char* mark_of(TestOutcome outcome) {
  switch (outcome) {
    case TestOutcome::passed:
      return "ok";
    case TestOutcome::failed:
      return "FAIL";
    case TestOutcome::expected_failure:
      return "limit";
    case TestOutcome::not_applicable:
      return "-";
  }
  return "?";
}

/// Groups rows by case.
std::vector<std::vector<const TestRow*>> by_case(const StabilityRun& run) {
  std::vector<std::vector<const TestRow*>> cases;
  for (const TestRow& row : run.rows) {
    if (cases.empty() || cases.back()[0]->hard_case != row.hard_case) cases.emplace_back();
    cases.back().push_back(&row);
  }
  return cases;
}

std::string table_row(const std::vector<const TestRow*>& rows) {
  const HardCase& hard_case = *rows[0]->hard_case;
  std::string text = fmt::format("  {:<32}", hard_case.name);
  double seconds = 0;
  for (const TestRow* row : rows) seconds += row->result.seconds;
  if (!hard_case.criterion.refused.empty()) {
    text += fmt::format("  {:<6}{:>58.2f}\n", mark_of(rows[0]->result.outcome), seconds);
    return text;
  }
  for (const Named<Solver>& solver : solver_names)
    for (const Named<Precision>& precision : precision_names) {
      const auto here = std::ranges::find_if(rows, [&](const TestRow* row) {
        return row->configuration.solver == solver.value && row->configuration.precision == precision.value;
      });
      text += fmt::format("  {:<7}", here == rows.end() ? "" : mark_of((*here)->result.outcome));
    }
  return text + fmt::format("{:>10.2f}\n", seconds);
}

std::string counts_text(const StabilityRun& run) {
  const std::int64_t passed = run.count(TestOutcome::passed), failed = run.count(TestOutcome::failed),
                     limits = run.count(TestOutcome::expected_failure), ran = passed + failed + limits;
  std::string text = fmt::format(
      "{} trials of {} on {}{}: {} passed, {} failed, {} declared {}", ran,
      by_case(run).size() == 1 ? "1 case" : fmt::format("{} cases", by_case(run).size()), run.device,
      run.extended ? ", long" : "", passed, failed, limits, limits == 1 ? "limit" : "limits");
  if (limits > 0)
    text += fmt::format(" (one in {:.3g})", static_cast<double>(ran) / static_cast<double>(limits));
  text += fmt::format("; {} not applicable; {:.1f} s", run.count(TestOutcome::not_applicable), run.seconds);
  if (run.asked > std::ssize(run.rows))
    text += fmt::format("; interrupted, {} trials not finished", run.asked - std::ssize(run.rows));
  return text + "\n";
}

}  // namespace

std::int64_t StabilityRun::count(TestOutcome outcome) const {
  return std::ranges::count_if(rows, [&](const TestRow& row) { return row.result.outcome == outcome; });
}

std::string name_of(const HardCase& hard_case, const TestConfiguration& configuration) {
  if (!hard_case.criterion.refused.empty()) return hard_case.name;
  return fmt::format("{}, {} {}", hard_case.name, name_of(solver_names, configuration.solver),
                     name_of(precision_names, configuration.precision));
}

std::string stability_json(const StabilityRun& run) {
  Json json{{"suite", "stability"},
            {"physics_version", physics_version},
            {"device", run.device},
            {"executor", name_of(run.executor)},
            {"long", run.extended},
            {"complete", run.asked == std::ssize(run.rows)},
            {"passed", run.count(TestOutcome::passed)},
            {"failed", run.count(TestOutcome::failed)},
            {"declared_limits", run.count(TestOutcome::expected_failure)},
            {"not_applicable", run.count(TestOutcome::not_applicable)},
            {"seconds", run.seconds},
            {"cases", Json::array()},
            {"trials", Json::array()}};
  for (const auto& rows : by_case(run)) json["cases"].push_back(json_of(*rows[0]->hard_case));
  for (const TestRow& row : run.rows) json["trials"].push_back(json_of(row));
  return json_text(json);
}

std::string stability_text(const StabilityRun& run) {
  std::string text =
      fmt::format("{:<34}  {:<16}  {:<16}  {:<16}\n{:<34}", "", "impulse", "soft_step", "jacobi_split", "");
  for (int k = 0; k < 3; ++k) text += fmt::format("  {:<7}  {:<7}", "f32", "f64");
  text += fmt::format("{:>10}\n", "s");
  std::string group;
  for (const auto& rows : by_case(run)) {
    const Criterion& criterion = rows[0]->hard_case->criterion;
    if (criterion.group != group) text += criterion.group + "\n";
    group = criterion.group;
    text += table_row(rows);
    for (const TestRow* row : rows)
      if (row->result.outcome == TestOutcome::failed)
        text += fmt::format("    {}: {}\n", name_of(*row->hard_case, row->configuration), row->result.why);
  }
  if (run.count(TestOutcome::expected_failure) > 0) text += "\ndeclared limits\n";
  for (const TestRow& row : run.rows)
    if (row.result.outcome == TestOutcome::expected_failure)
      text += fmt::format("  {}: {} ({})\n", name_of(*row.hard_case, row.configuration), row.result.why,
                          row.result.failure);
  return text + "\n" + counts_text(run);
}

std::string injected_faults_json(const std::vector<InjectedFaultRow>& rows) {
  Json json{{"suite", "stability"}, {"physics_version", physics_version}, {"planted", Json::array()}};
  for (const InjectedFaultRow& row : rows) {
    const Criterion& criterion = row.hard_case->criterion;
    const std::size_t assertion = criterion.injected_faults[row.fault].assertion;
    json["planted"].push_back(
        {{"case", row.hard_case->name},
         {"fault", row.fault},
         {"shows", row.shows},
         {"failure", row.result.failure},
         {"term", json_of(criterion.assertions[assertion], row.result.assertions[assertion])}});
  }
  return json_text(json);
}

std::string injected_faults_text(const std::vector<InjectedFaultRow>& rows) {
  std::string text;
  std::int64_t hidden = 0;
  for (const InjectedFaultRow& row : rows) {
    const Criterion& criterion = row.hard_case->criterion;
    const Assertion& assertion = criterion.assertions[criterion.injected_faults[row.fault].assertion];
    const AssertionResult& result = row.result.assertions[criterion.injected_faults[row.fault].assertion];
    hidden += row.shows ? 0 : 1;
    text += fmt::format("  {:<32}  {:<4}  {}", row.hard_case->name, row.shows ? "ok" : "FAIL",
                        text_of(assertion));
    if (row.shows)
      text += fmt::format(": {} at state {}\n", text_of(assertion.quantity, result.value), result.state);
    else if (!row.result.failure.empty())
      text += fmt::format(": the run failed: {}\n", row.result.failure);
    else
      text += fmt::format(": passed despite fault {}\n", row.fault + 1);
  }
  return text + fmt::format("\n{} faults injected: {}\n", rows.size(),
                            hidden == 0 ? "all detected" : fmt::format("{} not detected", hidden));
}

}  // namespace collidoscope
