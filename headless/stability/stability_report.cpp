#include "headless/stability/stability_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/reporting/report.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(ExecutorKind executor) { return executor == ExecutorKind::cuda ? "cuda" : "cpu"; }

template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of(const Term& term, const TermResult& result) {
  return {{"term", text_of(term)},
          {"quantity", collidoscope::name_of(quantity_names, term.quantity)},
          {"measured", result.measured},
          {"held", result.held},
          {"worst", result.measured ? Json(result.value) : Json(nullptr)},
          {"bound", result.measured ? Json(result.bound) : Json(nullptr)},
          {"state", result.state},
          {"body", or_null(result.body)}};
}

Json json_of(const TrialRow& row) {
  const TrialResult& result = row.result;
  const bool refused = !row.one->criterion.refused.empty();
  Json terms = Json::array();
  for (std::size_t k = 0; k < result.terms.size() && !refused; ++k)
    terms.push_back(json_of(row.one->criterion.holds[k], result.terms[k]));
  const TermResult* failed = result.failed_term ? &result.terms[*result.failed_term] : nullptr;
  return {
      {"case", row.one->name},
      {"group", row.one->criterion.group},
      {"solver", refused ? Json(nullptr) : Json(collidoscope::name_of(solver_names, row.setting.solver))},
      {"precision",
       refused ? Json(nullptr) : Json(collidoscope::name_of(precision_names, row.setting.precision))},
      {"executor", name_of(row.setting.executor)},
      {"verdict", collidoscope::name_of(verdict_names, result.verdict)},
      {"why", result.why},
      {"failure", result.failure},
      {"failing_state", failed ? Json(failed->state) : Json(nullptr)},
      {"failing_body", failed ? or_null(failed->body) : Json(nullptr)},
      {"terms", std::move(terms)},
      {"steps", result.steps},
      {"state_hash", result.state_hash ? Json(fmt::format("{:016x}", *result.state_hash)) : Json(nullptr)},
      {"seconds", result.seconds}};
}

Json json_of(const DeclaredLimit& limit) {
  return {{"solver", limit.solver ? Json(collidoscope::name_of(solver_names, *limit.solver)) : Json(nullptr)},
          {"precision",
           limit.precision ? Json(collidoscope::name_of(precision_names, *limit.precision)) : Json(nullptr)},
          {"executor", limit.executor ? Json(name_of(*limit.executor)) : Json(nullptr)},
          {"why", limit.why}};
}

Json json_of(const HardCase& one) {
  Json limits = Json::array();
  for (const DeclaredLimit& limit : one.criterion.limits) limits.push_back(json_of(limit));
  return {{"name", one.name},
          {"group", one.criterion.group},
          {"what", one.criterion.what},
          {"limits", std::move(limits)}};
}

const char* mark_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "ok";
    case Verdict::failed:
      return "FAIL";
    case Verdict::declared_limit:
      return "limit";
    case Verdict::not_applicable:
      return "-";
  }
  return "?";
}

/// Rows of one case.
std::vector<std::vector<const TrialRow*>> by_case(const StabilityRun& run) {
  std::vector<std::vector<const TrialRow*>> cases;
  for (const TrialRow& row : run.rows) {
    if (cases.empty() || cases.back()[0]->one != row.one) cases.emplace_back();
    cases.back().push_back(&row);
  }
  return cases;
}

std::string table_row(const std::vector<const TrialRow*>& rows) {
  const HardCase& one = *rows[0]->one;
  std::string text = fmt::format("  {:<32}", one.name);
  double seconds = 0;
  for (const TrialRow* row : rows) seconds += row->result.seconds;
  if (!one.criterion.refused.empty()) {
    text += fmt::format("  {:<6}{:>58.2f}\n", mark_of(rows[0]->result.verdict), seconds);
    return text;
  }
  for (const Named<Solver>& solver : solver_names)
    for (const Named<Precision>& precision : precision_names) {
      const auto here = std::ranges::find_if(rows, [&](const TrialRow* row) {
        return row->setting.solver == solver.value && row->setting.precision == precision.value;
      });
      text += fmt::format("  {:<7}", here == rows.end() ? "" : mark_of((*here)->result.verdict));
    }
  return text + fmt::format("{:>10.2f}\n", seconds);
}

std::string counts_text(const StabilityRun& run) {
  const std::int64_t passed = run.count(Verdict::passed), failed = run.count(Verdict::failed),
                     limits = run.count(Verdict::declared_limit), ran = passed + failed + limits;
  std::string text = fmt::format(
      "{} trials of {} on {}{}: {} passed, {} failed, {} declared {}", ran,
      by_case(run).size() == 1 ? "a case" : fmt::format("{} cases", by_case(run).size()), run.device,
      run.extended ? ", long" : "", passed, failed, limits, limits == 1 ? "limit" : "limits");
  if (limits > 0)
    text += fmt::format(" (one in {:.3g})", static_cast<double>(ran) / static_cast<double>(limits));
  text += fmt::format("; {} not applicable; {:.1f} s", run.count(Verdict::not_applicable), run.seconds);
  if (run.asked > std::ssize(run.rows))
    text += fmt::format("; stopped, {} trials did not end", run.asked - std::ssize(run.rows));
  return text + "\n";
}

}  // namespace

std::int64_t StabilityRun::count(Verdict verdict) const {
  return std::ranges::count_if(rows, [&](const TrialRow& row) { return row.result.verdict == verdict; });
}

std::string name_of(const HardCase& one, const TrialSetting& setting) {
  if (!one.criterion.refused.empty()) return one.name;
  return fmt::format("{}, {} {}", one.name, name_of(solver_names, setting.solver),
                     name_of(precision_names, setting.precision));
}

std::string stability_json(const StabilityRun& run) {
  Json json{{"suite", "stability"},
            {"device", run.device},
            {"executor", name_of(run.executor)},
            {"long", run.extended},
            {"complete", run.asked == std::ssize(run.rows)},
            {"passed", run.count(Verdict::passed)},
            {"failed", run.count(Verdict::failed)},
            {"declared_limits", run.count(Verdict::declared_limit)},
            {"not_applicable", run.count(Verdict::not_applicable)},
            {"seconds", run.seconds},
            {"cases", Json::array()},
            {"trials", Json::array()}};
  for (const auto& rows : by_case(run)) json["cases"].push_back(json_of(*rows[0]->one));
  for (const TrialRow& row : run.rows) json["trials"].push_back(json_of(row));
  return json_text(json);
}

std::string stability_text(const StabilityRun& run) {
  std::string text =
      fmt::format("{:<34}  {:<16}  {:<16}  {:<16}\n{:<34}", "", "impulse", "soft_step", "jacobi_split", "");
  for (int k = 0; k < 3; ++k) text += fmt::format("  {:<7}  {:<7}", "f32", "f64");
  text += fmt::format("{:>10}\n", "s");
  std::string group;
  for (const auto& rows : by_case(run)) {
    const Criterion& criterion = rows[0]->one->criterion;
    if (criterion.group != group) text += criterion.group + "\n";
    group = criterion.group;
    text += table_row(rows);
    for (const TrialRow* row : rows)
      if (row->result.verdict == Verdict::failed)
        text += fmt::format("    {}: {}\n", name_of(*row->one, row->setting), row->result.why);
  }
  if (run.count(Verdict::declared_limit) > 0) text += "\ndeclared limits\n";
  for (const TrialRow& row : run.rows)
    if (row.result.verdict == Verdict::declared_limit)
      text +=
          fmt::format("  {}: {} ({})\n", name_of(*row.one, row.setting), row.result.why, row.result.failure);
  return text + "\n" + counts_text(run);
}

std::string planted_json(const std::vector<PlantedRow>& rows) {
  Json json{{"suite", "stability"}, {"planted", Json::array()}};
  for (const PlantedRow& row : rows) {
    const Criterion& criterion = row.one->criterion;
    const std::size_t term = criterion.faults[row.fault].term;
    json["planted"].push_back({{"case", row.one->name},
                               {"fault", row.fault},
                               {"shows", row.shows},
                               {"failure", row.result.failure},
                               {"term", json_of(criterion.holds[term], row.result.terms[term])}});
  }
  return json_text(json);
}

std::string planted_text(const std::vector<PlantedRow>& rows) {
  std::string text;
  std::int64_t hidden = 0;
  for (const PlantedRow& row : rows) {
    const Criterion& criterion = row.one->criterion;
    const Term& term = criterion.holds[criterion.faults[row.fault].term];
    const TermResult& result = row.result.terms[criterion.faults[row.fault].term];
    hidden += row.shows ? 0 : 1;
    text += fmt::format("  {:<32}  {:<4}  {}", row.one->name, row.shows ? "ok" : "FAIL", text_of(term));
    if (row.shows)
      text += fmt::format(": {} at state {}\n", text_of(term.quantity, result.value), result.state);
    else if (!row.result.failure.empty())
      text += fmt::format(": the run failed: {}\n", row.result.failure);
    else
      text += fmt::format(": holds in spite of fault {}\n", row.fault + 1);
  }
  return text + fmt::format("\n{} faults planted: {}\n", rows.size(),
                            hidden == 0 ? "each fails its term" : fmt::format("{} show nowhere", hidden));
}

}  // namespace collidoscope
