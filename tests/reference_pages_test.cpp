// The generated tables of the documents: each page has the table that the program prints or that result files
// give, each table is in one page, and the references name all members of reports and of scene files.
// UPDATE_GOLDENS=1 writes the pages.

#include "headless/markdown/reference_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "headless/markdown/cells.h"
#include "headless/reporting/report.h"
#include "headless/reporting/report_fields.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/settings.h"
#include "sim_cuda/world.h"
#include "tests/result_tables.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view begin_mark = "<!-- begin generated: ", begin_mark_end = " -->\n",
                           end_mark = "<!-- end generated -->", reference_source = "help --markdown ",
                           result_source = "results ";

/// The table of a mark: "help --markdown TOPIC" or "results NAME".
std::string generated_table(std::string_view source) {
  if (source.starts_with(reference_source)) return reference_table(source.substr(reference_source.size()));
  if (source.starts_with(result_source)) return result_table(source.substr(result_source.size()));
  throw InputError("a mark has an unknown source");
}

/// The page with each table generated again. Adds the sources to `sources`. Throws InputError for an unknown
/// source and for a mark without its end.
std::string with_generated_tables(const std::string& page, std::vector<std::string>& sources) {
  std::string result;
  std::size_t at = 0;
  for (std::size_t begin; (begin = page.find(begin_mark, at)) != page.npos;) {
    const std::size_t name = begin + begin_mark.size(), name_end = page.find(begin_mark_end, name);
    const std::size_t end = page.find(end_mark, name);
    if (name_end == page.npos || end == page.npos || name_end > end)
      throw InputError("a mark of a generated table lacks its end");
    sources.push_back(page.substr(name, name_end - name));
    result += page.substr(at, name_end + begin_mark_end.size() - at) + '\n' +
              generated_table(sources.back()) + '\n';
    at = end;
  }
  return result + page.substr(at);
}

/// Pages of the project, by path.
std::map<std::string, std::string> project_pages() {
  namespace fs = std::filesystem;
  std::map<std::string, std::string> pages;
  const auto add = [&](const fs::path& file) {
    if (file.extension() == ".md") pages[file.string()] = text_of(file);
  };
  for (const auto& entry : fs::directory_iterator(project_file(""))) add(entry.path());
  for (const char* folder : {"assets", "headless", "sim_cuda", "tests", "ui", "viewer"})
    if (fs::exists(project_file(folder)))
      for (const auto& entry : fs::recursive_directory_iterator(project_file(folder))) add(entry.path());
  return pages;
}

/// A bundle has no pages of the source folders.
bool is_bundle() { return !std::filesystem::exists(project_file("sim_cuda")); }

TEST(ReferencePages, HoldTheGeneratedTables) {
  const bool update = std::getenv("UPDATE_GOLDENS") != nullptr;
  for (const auto& [file, page] : project_pages()) {
    std::vector<std::string> sources;
    const std::string expected = with_generated_tables(page, sources);
    if (update && page != expected) std::ofstream(file, std::ios::binary) << expected;
    EXPECT_TRUE(update || page == expected)
        << file << " is out of date; UPDATE_GOLDENS=1 ./dev test -R '^ReferencePages' writes it";
  }
}

TEST(ReferencePages, HaveEachTableOnce) {
  if (is_bundle()) GTEST_SKIP() << "a bundle has no pages";
  std::vector<std::string> sources, known;
  for (const auto& [file, page] : project_pages()) with_generated_tables(page, sources);
  for (const ReferenceTopic& topic : reference_topics())
    known.push_back(std::string(reference_source) + std::string(topic.name));
  for (const std::string_view name : result_table_names())
    known.push_back(std::string(result_source) + std::string(name));
  EXPECT_THAT(sources, testing::UnorderedElementsAreArray(known));
}

TEST(ReferencePages, RefuseUnknownSourcesAndOpenMarks) {
  std::vector<std::string> sources;
  const std::string end(end_mark);
  const auto begin = [](const std::string& source) {
    return std::string(begin_mark) + source + std::string(begin_mark_end);
  };
  const std::string breaks = begin("help --markdown breaks");
  EXPECT_EQ(with_generated_tables("a\n" + breaks + "old\n" + end + "\nb\n", sources),
            "a\n" + breaks + '\n' + reference_table("breaks") + '\n' + end + "\nb\n");
  EXPECT_THROW(with_generated_tables(breaks + "old\n", sources), InputError);
  for (const char* unknown : {"help --markdown brakes", "results step", "breaks"})
    EXPECT_THROW(with_generated_tables(begin(unknown) + end, sources), InputError) << unknown;
}

TEST(ReferencePages, AreWhatTheProgramPrints) {
  EXPECT_EQ(run_headless({"help", "--markdown", "scene"}).out, reference_table("scene"));
  const Outcome list = run_headless({"help", "--markdown"});
  EXPECT_EQ(list.status, 0);
  EXPECT_EQ(list.out, "flags\nscene\neffects\nchanges\nreport\nbroad-phases\nbreaks\nquantities\n");
  const Outcome unknown = run_headless({"help", "--markdown", "scenes"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.out, "");
  EXPECT_THAT(unknown.err,
              testing::StartsWith("help --markdown: unknown topic \"scenes\"; did you mean \"scene\"?"));
  EXPECT_EQ(unknown.err.find('\n'), unknown.err.size() - 1) << "one line";
  EXPECT_EQ(run_headless({"help", "--markdown", "scene", "flags"}).status, 2);
}

TEST(ReferencePages, HaveCellsInEveryColumn) {
  for (const ReferenceTopic& topic : reference_topics()) {
    std::istringstream lines(topic.table());
    std::ptrdiff_t columns = 0;
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with('|')) {
        columns = 0;
        continue;
      }
      const auto bars = std::ranges::count(line, '|');
      std::ptrdiff_t escaped = 0;
      for (std::size_t at = 0; (at = line.find("\\|", at)) != line.npos; at += 2) ++escaped;
      if (columns == 0) columns = bars;
      EXPECT_EQ(bars - escaped, columns) << topic.name << ": " << line;
    }
  }
}

TEST(ReferenceCells, WriteTextsAsMarkdown) {
  EXPECT_EQ(prose("auto: 2 |gravity| time_step; not with impulse, --load"),
            "`auto`: 2 |gravity| `time_step`; not with `impulse`, `--load`");
  EXPECT_EQ(prose("an impulse of `a_b*c` in m^2, B*T, \"world\""),
            "an impulse of `a_b*c` in m², B·T, `\"world\"`");
  EXPECT_EQ(number_text(1000), "1000");
  EXPECT_EQ(number_text(-1e6), "−10⁶");
  EXPECT_EQ(number_text(1e-9), "10⁻⁹");
  EXPECT_EQ(number_text(1 << 27), "2²⁷");
  EXPECT_EQ(number_text(0.47), "0.47");
  EXPECT_EQ(number_text(0), "0");
}

/// The paths of all members: '.' for objects, "[]" for lists of objects.
void add_paths(const ordered_json& value, const std::string& path, std::set<std::string>& paths) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items())
      add_paths(member, path.empty() ? key : path + '.' + key, paths);
    if (path.empty()) return;
  } else if (value.is_array() && !value.empty() && value[0].is_object()) {
    for (const ordered_json& entry : value) add_paths(entry, path + "[]", paths);
  }
  paths.insert(path);
}

/// Paths of `all` that `from` lacks.
std::vector<std::string> lacking(const std::set<std::string>& from, const std::set<std::string>& all) {
  std::vector<std::string> paths;
  for (const std::string& path : all) {
    // An object or an entry of a list needs no row if its members have theirs.
    const bool has_members =
        std::ranges::any_of(from, [&](const std::string& other) { return other.starts_with(path + '.'); });
    if (!from.contains(path) && !has_members) paths.push_back(path);
  }
  return paths;
}

/// With '*' for the names in the objects `any_names`.
std::set<std::string> paths_of(ordered_json json, const std::vector<std::string>& any_names) {
  for (const std::string& object : any_names) {
    ordered_json members = ordered_json::array();
    for (const auto& [name, member] : json.at(object).items()) members.push_back(member);
    json[object] = ordered_json::object();
    for (const ordered_json& member : members) {
      if (member.is_object())
        json[object]["*"].update(member);
      else
        json[object]["*"] = member;
    }
  }
  std::set<std::string> paths;
  add_paths(json, "", paths);
  return paths;
}

/// A report that has all optional members.
RunReport full_report() {
  Scene scene = box_collider(20);
  scene.physics.solver = Solver::soft_step;
  scene.physics.sleep = Sleep{};
  scene.physics.guards = ValidationSettings{};
  scene.bodies = {sphere(1, Vector3d(50, 50, 1)), sphere(1, Vector3d(50, 54, 1))};
  Joint joint;
  joint.a = 0;
  joint.b = 1;
  scene.joints = {joint};
  World world(scene, {});
  const StepStats initial = world.measure();
  world.records().record_residuals(true);
  world.step();
  world.step();
  RunReport report = make_report(world, initial, 1.0);
  report.finding = Finding{.stage = "forces"};
  report.failure = "a body is not finite";
  report.pair_check.emplace().compares = true;
  report.pair_check->examples = {{1, 2, PairFault::missing}};
  return report;
}

TEST(ReportFields, AreThoseOfARun) {
  std::set<std::string> fields;
  for (const ReportField& field : report_fields) EXPECT_TRUE(fields.emplace(field.path).second) << field.path;
  const RunReport report = full_report();
  ASSERT_FALSE(report.residuals.empty());
  const std::set<std::string> of_run = paths_of(json_of(report), {"effect_reasons", "settings"});
  EXPECT_THAT(lacking(fields, of_run), testing::IsEmpty()) << "in json_of(), not in report_fields.h";
  EXPECT_THAT(lacking(of_run, fields), testing::IsEmpty()) << "in report_fields.h, not in json_of()";
}

TEST(ReferencePages, NameAllMembersOfAScene) {
  std::set<std::string> fields;
  std::istringstream lines(reference_table("scene"));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("| `")) fields.insert(line.substr(3, line.find('`', 3) - 3));
  const std::string text = text_of(project_file("tests/fuzz/corpus/scene/all.json"));
  ordered_json scene = ordered_json::parse(text, nullptr, true, true);
  scene["extra_bodies"] = ordered_json::array();  // its entries are those of `bodies`
  EXPECT_THAT(lacking(fields, paths_of(scene, {"materials"})), testing::IsEmpty());
}

TEST(ReferencePages, NameAllSettingsOfChanges) {
  const std::string table = reference_table("changes");
  for_each_setting([&](const auto& setting) {
    const bool stands = table.find("| `" + std::string(setting.name) + "` |") != table.npos;
    EXPECT_EQ(stands, setting.live != Live::never) << setting.name;
  });
}

}  // namespace
}  // namespace collidoscope
