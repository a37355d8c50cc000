// Tests the stability table in assets/results/stability.md: its text for results of several machines, and its
// list of the cases in assets/scenes/hard.

#include "headless/stability/stability_readme.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "sim_cuda/core/error.h"
#include "sim_cuda/stability/hard_case.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

/// The output of --json, as far as the table uses it. The test runs of `stack` use impulse and soft_step,
/// both in float.
std::string run(const std::string& executor, const std::string& first, const std::string& second,
                const std::string& hash) {
  const auto test_run = [&](const std::string& name, const std::string& solver, const std::string& outcome) {
    return R"({"case": ")" + name + R"(", "solver": )" + solver + R"(, "precision": "f32", "executor": ")" +
           executor + R"(", "verdict": ")" + outcome + R"(", "state_hash": ")" + hash + "\"}";
  };
  return R"({"suite": "stability", "device": "the )" + executor + R"(", "executor": ")" + executor +
         R"(", "passed": 2, "failed": 0, "declared_limits": 1, "seconds": 61.5, "cases": [
           {"name": "bad", "group": "bad input", "what": "is refused", "limits": []},
           {"name": "stack", "group": "stacks", "what": "it stands", "limits": [
             {"solver": "impulse", "precision": null, "executor": null, "fails": ["penetration at most 2 m"], "why": "it sinks"}]}], "trials": [)" +
         test_run("stack", "\"impulse\"", first) + "," + test_run("stack", "\"soft_step\"", second) + "," +
         test_run("bad", "null", "passed") + "]}";
}

TEST(StabilityReadme, TellsEachCaseAndLimit) {
  const std::string text = stability_markdown({{"a", run("cpu", "declared limit", "passed", "1")}});
  EXPECT_THAT(text,
              HasSubstr("| **stacks** | | | | | |\n| `stack` | it stands | L – | ✓ – | – – | CPU |\n"
                        "| **bad input** | | | | | |\n| `bad` | is refused | ✓ ✓ | ✓ ✓ | ✓ ✓ | CPU |\n"));
  EXPECT_THAT(text, HasSubstr("the cpu (CPU, 62 s): 3 trials, 2 pass, 1 at declared limits, 0 fail.\n"));
  EXPECT_THAT(text, HasSubstr("Declared limits: 1 of 3 trials, one in 3.\n\n- `stack`, `impulse`: it sinks. "
                              "Bounds that hold: penetration at most 2 m\n"));
}

TEST(StabilityReadme, ComparesMachines) {
  const std::string cpu = run("cpu", "declared limit", "passed", "1");
  const auto with = [&](const std::string& gpu) { return stability_markdown({{"a", cpu}, {"b", gpu}}); };
  const std::string same = with(run("cuda", "declared limit", "passed", "1"));
  EXPECT_THAT(same, HasSubstr("| L – | ✓ – | – – | same |"));
  EXPECT_THAT(same, HasSubstr("Declared limits: 2 of 6 trials, one in 3.\n"));
  EXPECT_THAT(with(run("cuda", "declared limit", "passed", "2")), HasSubstr("| **differ** |"));
  EXPECT_THAT(with(run("cuda", "declared limit", "failed", "1")), HasSubstr("| L – | ✓ **✗** – |"));
  EXPECT_THAT(with(run("cuda", "not applicable", "not applicable", "")),
              HasSubstr("| L – | ✓ – | – – | CPU |"));
}

TEST(StabilityReadme, ComparesNoHashesOfDifferentPhysics) {
  const auto with = [](const std::string& version, const std::string& file) {
    const std::string suite = R"({"suite": "stability", )";
    return suite + R"("physics_version": )" + version + ", " + file.substr(suite.size());
  };
  const std::string cpu = run("cpu", "declared limit", "passed", "1"),
                    gpu = run("cuda", "declared limit", "passed", "2");
  const std::string text = stability_markdown({{"a", cpu}, {"b", with("2", gpu)}});
  EXPECT_THAT(text, HasSubstr("| L – | ✓ – | – – | both |"));
  EXPECT_THAT(text, testing::Not(HasSubstr("**differ**")));
  EXPECT_THAT(text, HasSubstr("\nCannot compare hashes: the cpu (CPU): physics version 1; the cuda (CUDA): "
                              "physics version 2.\n"));
  // A file without the number has version 1.
  const std::string first = stability_markdown({{"a", cpu}, {"b", with("1", gpu)}});
  EXPECT_THAT(first, HasSubstr("| **differ** |"));
  EXPECT_THAT(first, testing::Not(HasSubstr("Cannot compare hashes")));
  // Other files of the same version are still compared.
  EXPECT_THAT(stability_markdown({{"a", cpu}, {"b", with("2", cpu)}, {"c", with("2", gpu)}}),
              HasSubstr("| **differ** |"));
}

TEST(StabilityReadme, StandsBetweenItsMarks) {
  EXPECT_EQ(with_stability("a\n<!-- stability -->\nold\n<!-- /stability -->\nb\n", "r", "new\n"),
            "a\n<!-- stability -->\n\nnew\n\n<!-- /stability -->\nb\n");
  EXPECT_THROW(with_stability("a\n<!-- stability -->\n", "r", "new\n"), InputError);
  EXPECT_THROW(stability_markdown({{"a", "{}"}}), InputError);
  EXPECT_THROW(stability_markdown({{"a", "not JSON"}}), InputError);
}

TEST(StabilityReadme, IsWrittenFromFiles) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.json") << run("cpu", "passed", "passed", "1");
  std::ofstream(folder / "README.md") << "a\n<!-- stability -->\n<!-- /stability -->\nb\n";
  rewrite_readme(folder / "README.md", {folder / "a.json"});
  EXPECT_THAT(text_of(folder / "README.md"), HasSubstr("| `stack` |"));
  EXPECT_THROW(rewrite_readme(folder / "README.md", {folder / "b.json"}), InputError);
}

/// The rest of each line with this beginning, between the marks of the results page.
std::vector<std::string> lines_of_page(const std::string& beginning) {
  const std::string page = text_of(project_file("assets/results/stability.md"));
  const std::size_t begin = page.find(stability_begin), end = page.find(stability_end);
  std::vector<std::string> found;
  if (begin == std::string::npos || end == std::string::npos) return found;
  std::istringstream lines(page.substr(begin, end - begin));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(beginning)) found.push_back(line.substr(beginning.size()));
  return found;
}

TEST(StabilityPage, ListsAllCasesAndTheirLimits) {
  std::multiset<std::string> cases, limits, listed_cases, listed_limits;
  for (const HardCase& one : read_hard_cases(project_file("assets/scenes/hard").string())) {
    std::string what = one.criterion.what;
    for (std::size_t at = 0; (at = what.find('|', at)) != std::string::npos; at += 2) what.insert(at, "\\");
    cases.insert(one.name + "` | " + what);
    for (const ExpectedFailure& limit : one.criterion.expected_failures) {
      std::string fails;
      for (const ExpectedFailureTerm& term : limit.fails)
        fails += (fails.empty() ? "" : ", ") + text_of(one.criterion.assertions[term.assertion], term);
      limits.insert(one.name + ": " + limit.why + ". Bounds that hold: " + fails);
    }
  }
  for (const std::string& line : lines_of_page("| `"))
    listed_cases.insert(line.substr(0, line.find(" |", line.find(" | ") + 3)));
  for (const std::string& line : lines_of_page("- `"))
    listed_limits.insert(line.substr(0, line.find('`')) + line.substr(line.find(": ", line.find("`, "))));
  const auto lacking = [](const std::multiset<std::string>& from, const std::multiset<std::string>& of) {
    std::vector<std::string> lines;
    std::ranges::set_difference(of, from, std::back_inserter(lines));
    return lines;
  };
  EXPECT_THAT(lacking(listed_cases, cases), testing::IsEmpty())
      << "stability --json FILE, then stability --write-table assets/results/stability.md --from FILE";
  EXPECT_THAT(lacking(cases, listed_cases), testing::IsEmpty()) << "cases that are no more";
  EXPECT_THAT(lacking(listed_limits, limits), testing::IsEmpty());
  EXPECT_THAT(lacking(limits, listed_limits), testing::IsEmpty()) << "limits that are no more";
}

TEST(StabilityPage, CpuAndGpuReachTheSameStates) {
  const std::vector<std::string> lines = lines_of_page("| `");
  EXPECT_FALSE(lines.empty());
  for (const std::string& line : lines) EXPECT_EQ(line.find("**differ**"), std::string::npos) << line;
}

}  // namespace
}  // namespace collidoscope
