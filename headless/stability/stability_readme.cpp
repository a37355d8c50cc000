#include "headless/stability/stability_readme.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "headless/cli/output_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/text_file.h"
#include "sim_cuda/stability/criterion.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t most_bytes = std::size_t{64} << 20;

/// The string member `key`, or "" if it is missing or not a string.
std::string word(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// Physics version of a result file.
int physics_version_of(const Json& run) {
  const auto found = run.find("physics_version");
  return found != run.end() && found->is_number_integer() ? found->get<int>() : first_physics_version;
}

/// All test runs of a case, by solver, precision and executor.
struct CaseRow {
  Json about;  ///< from the first file that contains the case
  std::vector<Json> test_runs;
  std::vector<int> physics_versions;  ///< of each test run

  std::vector<const Json*> of(std::string_view solver, std::string_view precision) const {
    std::vector<const Json*> found;
    for (const Json& test_run : test_runs)
      if (word(test_run, "solver").empty() ||
          (word(test_run, "solver") == solver && word(test_run, "precision") == precision))
        found.push_back(&test_run);
    return found;
  }
};

const char* readme_mark(const std::string& outcome) {
  if (outcome == "passed") return "✓";
  if (outcome == "declared limit") return "L";
  return outcome == "failed" ? "**✗**" : "–";
}

/// Combined mark of all machines. Tests that are not applicable on a machine are ignored.
std::string readme_mark(const std::vector<const Json*>& test_runs) {
  std::string mark;
  for (const Json* test_run : test_runs) {
    const std::string here = readme_mark(word(*test_run, "verdict"));
    if (mark.empty() || mark == "–" || here == mark)
      mark = here;
    else if (here != "–")
      mark += " " + here;
  }
  return mark.empty() ? "–" : mark;
}

/// Executors of the test runs, and whether all of them reached the same state. Hashes of different physics
/// versions are not compared.
std::string machines_text(const CaseRow& row) {
  bool cpu = false, cuda = false, differ = false;
  std::map<std::string, std::string> hashes;
  std::set<int> versions;
  for (std::size_t k = 0; k < row.test_runs.size(); ++k) {
    const Json& test_run = row.test_runs[k];
    if (word(test_run, "verdict") == "not applicable") continue;
    (word(test_run, "executor") == "cuda" ? cuda : cpu) = true;
    const std::string hash = word(test_run, "state_hash");
    if (hash.empty()) continue;
    const int version = row.physics_versions[k];
    versions.insert(version);
    const auto [known, fresh] = hashes.emplace(
        fmt::format("{} {} {}", word(test_run, "solver"), word(test_run, "precision"), version), hash);
    differ = differ || (!fresh && known->second != hash);
  }
  if (differ) return "**differ**";
  if (cpu && cuda) return versions.size() == 1 ? "same" : "both";
  return cpu ? "CPU" : cuda ? "GPU" : "–";
}

/// Escapes '|' for a Markdown table cell.
std::string escaped_cell(const std::string& text) {
  std::string escaped;
  for (const char letter : text) {
    if (letter == '|') escaped += '\\';
    escaped += letter;
  }
  return escaped;
}

std::string readme_row(const CaseRow& row) {
  std::string text =
      fmt::format("| `{}` | {} |", word(row.about, "name"), escaped_cell(word(row.about, "what")));
  for (const Named<Solver>& solver : solver_names)
    text += fmt::format(" {} {} |", readme_mark(row.of(solver.name, "f32")),
                        readme_mark(row.of(solver.name, "f64")));
  return text + " " + machines_text(row) + " |\n";
}

std::string limit_text(const std::string& name, const Json& limit) {
  std::string where;
  for (const char* key : {"solver", "precision", "executor"})
    if (const std::string value = word(limit, key); !value.empty())
      where += (where.empty() ? "`" : " `") + value + "`";
  std::string fails;
  for (const Json& term : limit.value("fails", Json::array()))
    if (term.is_string()) fails += (fails.empty() ? "" : ", ") + term.get<std::string>();
  return fmt::format("- `{}`, {}: {}{}\n", name, where, word(limit, "why"),
                     fails.empty() ? "" : fmt::format(". Bounds that hold: {}", fails));
}

/// "of 120 trials on an AMD EPYC (CPU) 110 pass".
std::string readme_counts(const std::vector<Json>& runs, std::int64_t& limits, std::int64_t& test_runs) {
  std::string text;
  for (const Json& run : runs) {
    const auto count = [&](const char* key) { return run.value(key, std::int64_t{0}); };
    const std::int64_t ran = count("passed") + count("failed") + count("declared_limits");
    limits += count("declared_limits");
    test_runs += ran;
    text += fmt::format("{}{} ({}, {:.0f} s{}): {} trials, {} pass, {} at declared limits, {} fail",
                        text.empty() ? "" : "; ", word(run, "device"),
                        word(run, "executor") == "cuda" ? "CUDA" : "CPU", run.value("seconds", 0.0),
                        run.value("long", false) ? ", long" : "", ran, count("passed"),
                        count("declared_limits"), count("failed"));
  }
  return text;
}

/// "Cannot compare hashes: an AMD EPYC (CPU): physics version 1; ...", or "" for files of one version.
std::string readme_versions(const std::vector<Json>& runs) {
  std::set<int> versions;
  std::string text;
  for (const Json& run : runs) {
    versions.insert(physics_version_of(run));
    text += fmt::format("{}{} ({}): physics version {}", text.empty() ? "" : "; ", word(run, "device"),
                        word(run, "executor") == "cuda" ? "CUDA" : "CPU", physics_version_of(run));
  }
  return versions.size() > 1 ? "\nCannot compare hashes: " + text + ".\n" : "";
}

}  // namespace

std::string stability_markdown(const std::vector<std::pair<std::string, std::string>>& files) {
  std::vector<Json> runs;
  std::vector<CaseRow> rows;
  for (const auto& [name, text] : files) {
    const Json& run = runs.emplace_back(Json::parse(text, nullptr, false));
    if (!run.is_object() || word(run, "suite") != "stability" || !run.contains("cases") ||
        !run.contains("trials"))
      throw InputError(name + ": not a report of stability --json");
    for (const Json& about : run["cases"])
      if (std::ranges::none_of(
              rows, [&](const CaseRow& row) { return word(row.about, "name") == word(about, "name"); }))
        rows.push_back({about, {}, {}});
    for (const Json& test_run : run["trials"])
      for (CaseRow& row : rows)
        if (word(row.about, "name") == word(test_run, "case")) {
          row.test_runs.push_back(test_run);
          row.physics_versions.push_back(physics_version_of(run));
        }
  }
  std::ranges::stable_sort(rows, {}, [](const CaseRow& row) {
    return std::ranges::find(hard_case_groups, word(row.about, "group")) - hard_case_groups.begin();
  });

  std::string text =
      "| case | what must hold | `impulse` | `soft_step` | `jacobi_split` | CPU, GPU "
      "|\n|---|---|---|---|---|---|\n";
  std::string group, limits_text;
  for (const CaseRow& row : rows) {
    if (word(row.about, "group") != group) {
      group = word(row.about, "group");
      text += fmt::format("| **{}** | | | | | |\n", group);
    }
    text += readme_row(row);
    for (const Json& limit : row.about.value("limits", Json::array()))
      limits_text += limit_text(word(row.about, "name"), limit);
  }
  std::int64_t limits = 0, test_runs = 0;
  const std::string counts = readme_counts(runs, limits, test_runs);
  text +=
      "\nTwo marks per solver, for f32 and f64: ✓ passed, L declared limit, – not applicable to this solver "
      "or executor, **✗** failed. *Same*: CPU and GPU reach bitwise equal states in each of these "
      "trials.\n\n" +
      counts + ".\n" + readme_versions(runs);
  if (limits_text.empty()) return text + "\nNo limits are declared.\n";
  text += fmt::format("\nDeclared limits: {} of {} trials", limits, test_runs);
  if (limits > 0)
    text += fmt::format(", one in {:.3g}", static_cast<double>(test_runs) / static_cast<double>(limits));
  return text + ".\n\n" + limits_text;
}

std::string with_stability(const std::string& readme, const std::string& name, const std::string& table) {
  const std::string begin_mark(stability_begin);
  const std::size_t begin = readme.find(begin_mark), end = readme.find(stability_end);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw InputError(fmt::format("{}: missing lines {} and {}, which enclose the table", name,
                                 stability_begin, stability_end));
  return readme.substr(0, begin + begin_mark.size()) + "\n\n" + table + "\n" + readme.substr(end);
}

void rewrite_readme(const std::string& readme, const std::vector<std::string>& from) {
  std::vector<std::pair<std::string, std::string>> runs;
  for (const std::string& file : from)
    runs.emplace_back(file, read_text_file(file, most_bytes, "a report of stability --json"));
  const std::string table = stability_markdown(runs);
  const std::string text =
      with_stability(read_text_file(readme, most_bytes, "a Markdown page"), readme, table);
  OutputFile output("--write-table", readme);
  output.write(text);
  output.commit();
}

}  // namespace collidoscope
