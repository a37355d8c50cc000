#include "tests/result_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "headless/markdown/cells.h"
#include "headless/reporting/report.h"
#include "sim_cuda/core/error.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::string>;

Json result(const std::string& file) { return Json::parse(text_of(project_file("assets/results/" + file))); }

std::string count(const Json& json) { return grouped(json.get<std::int64_t>()); }
std::string fixed(const Json& json, int decimals) {
  return fmt::format("{:.{}f}", json.get<double>(), decimals);
}

/// "1.003 (0.990 to 1.012)".
std::string spread(const Json& json, int decimals) {
  return fmt::format("{} ({} to {})", fixed(json["median"], decimals), fixed(json["p5"], decimals),
                     fixed(json["p95"], decimals));
}

std::string step_ms(const Json& report) {
  return fmt::format("{} ({})", fixed(report["step_median_ms"], 3), fixed(report["step_p95_ms"], 3));
}

/// "50,000 `scaled`".
std::string size_and_variant(const Json& report) {
  return fmt::format("{} {}", count(report["bodies"]), code(report["variant"].get<std::string>()));
}

const Json* named(const Json& list, const char* key, std::string_view name) {
  const auto found = std::ranges::find_if(list, [&](const Json& entry) { return entry[key] == name; });
  return found == list.end() ? nullptr : &*found;
}

// Whole steps, one row per report.

constexpr std::array run_names{"2000-paper",   "10000-paper",    "50000-paper",
                               "50000-scaled", "1000000-scaled", "10000000-scaled"};

std::string steps() {
  MarkdownTable table(
      {"N, variant", "steps", "whole step, ms (p95)", "pairs", "touching", "speculative", "bytes"});
  for (const std::string name : run_names) {
    const Json run = result("nvidia-h200/default-" + name + ".json");
    table.row({size_and_variant(run), count(run["steps"]), step_ms(run), count(run["pairs"]["aabb"]),
               count(run["pairs"]["touching"]), count(run["pairs"]["speculative"]),
               count(run["allocated_bytes"])});
  }
  return table.text();
}

std::string steps_of_impulse() {
  MarkdownTable table({"N, variant", "steps", "whole step, ms (p95)", "pairs", "contacts", "bytes"});
  for (const std::string name : run_names) {
    const Json run = result("nvidia-h200/box_collider-" + name + ".json");
    table.row({size_and_variant(run), count(run["steps"]), step_ms(run), count(run["pairs"]["aabb"]),
               count(run["pairs"]["contacts"]), count(run["allocated_bytes"])});
  }
  return table.text();
}

// Stages, one column per report.

std::string stages(const Cells& files) {
  std::vector<Json> runs;
  Cells columns{"stage (launches)"};
  for (const std::string& file : files) {
    runs.push_back(result("nvidia-h200/" + file + ".json"));
    columns.push_back(size_and_variant(runs.back()));
  }
  MarkdownTable table(columns);
  std::vector<double> sums(runs.size());
  int launches = 0;
  for (const Json& stage : runs[0]["stages"]) {
    Cells cells{fmt::format("{}{} ({})", stage["name"].get<std::string>(),
                            stage["library_launch"].get<bool>() ? " \\*" : "", stage["launches"].get<int>())};
    launches += stage["launches"].get<int>();
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const Json& same = *named(runs[k]["stages"], "name", stage["name"].get<std::string>());
      sums[k] += same["median_ms"].get<double>();
      cells.push_back(fixed(same["median_ms"], 4));
    }
    table.row(cells);
  }
  Cells sum{fmt::format("sum of the stages ({})", launches)}, step{"**whole step**, timed as a whole (p95)"},
      pairs{"pairs"}, contacts{"speculative contacts, and per body"};
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const double bodies = runs[k]["bodies"].get<double>();
    const Json& contact_count = runs[k]["pairs"].contains("speculative") ? runs[k]["pairs"]["speculative"]
                                                                         : runs[k]["pairs"]["contacts"];
    sum.push_back(fixed(sums[k], 3));
    step.push_back(step_ms(runs[k]));
    pairs.push_back(count(runs[k]["pairs"]["aabb"]));
    contacts.push_back(
        fmt::format("{}, {:.1f}", count(contact_count), 2 * contact_count.get<double>() / bodies));
  }
  if (runs[0]["solver"] == "impulse") contacts[0] = "contacts, and per body";
  for (const Cells& cells : {sum, step, pairs, contacts}) table.row(cells);
  return table.text();
}

std::string stages_of_impulse() {
  return stages({"box_collider-50000-paper", "box_collider-1000000-scaled"});
}

std::string stages_with_friction() {
  return stages({"soft_step-50000-settled-friction", "soft_step-50000-scaled-friction",
                 "soft_step-1000000-settled-friction", "soft_step-1000000-scaled-friction"});
}

/// Stages in groups: one sphere that touches thousands, beside the same grains on a floor.
std::string one_large_body() {
  const std::array runs{result("nvidia-h200/planet-48401.json"), result("nvidia-h200/floor-48400.json")};
  const std::vector<std::pair<std::string, Cells>> groups{{"pairs", {"pairs"}},
                                                          {"contacts", {"contacts"}},
                                                          {"prepare", {"prepare"}},
                                                          {"forces", {"forces"}},
                                                          {"solve and relax", {"solve", "relax"}},
                                                          {"bounce and friction", {"bounce", "friction"}},
                                                          {"all others", {}}};
  MarkdownTable table({"stage, ms", "large sphere, processed by a block", "floor"});
  for (const auto& [title, names] : groups) {
    Cells cells{title};
    for (const Json& run : runs) {
      double sum = 0;
      for (const Json& stage : run["stages"]) {
        const auto is_stage = [&](const std::string& name) { return stage["name"] == name; };
        const bool grouped_elsewhere = std::ranges::any_of(
            groups, [&](const auto& group) { return std::ranges::any_of(group.second, is_stage); });
        if (names.empty() ? !grouped_elsewhere : std::ranges::any_of(names, is_stage))
          sum += stage["median_ms"].get<double>();
      }
      cells.push_back(fixed(sum, 2));
    }
    table.row(cells);
  }
  table.row({"**whole step** (p95)", step_ms(runs[0]), step_ms(runs[1])});
  return table.text();
}

// Broad phases: one row per method, one column per size.

/// One decimal, none from 1,000.
std::string rounded(double value) { return value < 1000 ? fixed(value, 1) : grouped(std::llround(value)); }

std::string broad_phases(const char* file, const Cells& variants) {
  constexpr double bytes_per_us = 4.3e6;  // memory bandwidth of the H200
  const Json rows = result(file)["rows"];
  std::vector<std::pair<std::string, std::int64_t>> sizes;
  Cells methods, columns{"method, µs"};
  for (const std::string& variant : variants)
    for (const Json& row : rows) {
      const std::pair size(variant, row["bodies"].get<std::int64_t>());
      if (row["variant"] == variant && std::ranges::find(sizes, size) == sizes.end()) sizes.push_back(size);
    }
  std::ranges::stable_sort(sizes, {}, [&](const auto& size) {
    return std::pair(std::ranges::find(variants, size.first), size.second);
  });
  for (const auto& [variant, bodies] : sizes)
    columns.push_back(
        fmt::format("{}N = {}", variants.size() > 1 ? code(variant) + ", " : "", grouped(bodies)));
  for (const Json& row : rows)
    if (std::ranges::find(methods, row["method"].get<std::string>()) == methods.end())
      methods.push_back(row["method"]);

  MarkdownTable table(columns);
  const auto add_row = [&](const std::string& title, const std::string& method, const auto& cell) {
    Cells cells{title};
    for (const auto& [variant, bodies] : sizes) {
      const auto found =
          std::ranges::find_if(rows, [&, &variant = variant, &bodies = bodies](const Json& row) {
            return row["method"] == method && row["variant"] == variant && row["bodies"] == bodies;
          });
      cells.push_back(found == rows.end() ? "–" : cell(*found));
    }
    table.row(cells);
  };
  for (const std::string& method : methods)
    add_row(method.starts_with("cuBQL") ? "cuBQL 1.1 (list unordered)" : code(method), method,
            [](const Json& row) { return rounded(row["median_us"].get<double>()); });
  add_row("pairs", "lbvh_ropes", [](const Json& row) { return count(row["pairs"]); });
  add_row("floor", "lbvh_ropes",
          [](const Json& row) { return fixed(row["floor_bytes"].get<double>() / bytes_per_us, 2); });
  add_row("`lbvh_ropes`: bytes per body", "lbvh_ropes",
          [](const Json& row) { return fixed(row["bytes"].get<double>() / row["bodies"].get<double>(), 0); });
  return table.text();
}

std::string broad_phases_scaled() { return broad_phases("nvidia-h200/broad-phases-scaled.json", {"scaled"}); }
std::string broad_phases_variants() {
  return broad_phases("nvidia-h200/broad-phases-variants.json", {"paper", "equal"});
}

std::string growth() {
  const Json scaling = result("nvidia-h200/scaling.json");
  std::int64_t largest = 0;
  for (const Json& row : scaling["rows"]) largest = std::max(largest, row["bodies"].get<std::int64_t>());
  const std::string last_column = fmt::format("ns per body at N = {}", grouped(largest));
  MarkdownTable table({"method", "fixed, µs", "exponent", "fit error", last_column});
  for (const Json& fit : scaling["growth"]) {
    for (const Json& row : scaling["rows"])
      if (row["method"] == fit["method"] && row["bodies"] == largest)
        table.row({code(fit["method"].get<std::string>()), fixed(fit["fixed_us"], 1),
                   fmt::format("{} ({} to {})", fixed(fit["exponent"], 2), fixed(fit["exponent_least"], 2),
                               fixed(fit["exponent_most"], 2)),
                   fixed(100 * fit["relative_error"].get<double>(), 1) + " %",
                   fixed(1000 * row["median_us"].get<double>() / static_cast<double>(largest), 2)});
  }
  return table.text();
}

std::string predictors() {
  MarkdownTable table({"measure", "same query, within a scene", "same query, all",
                       "own query, within a scene", "own query, all"});
  const Json suite = result("nvidia-h200/predictors.json");
  for (const Json& row : suite["correlations"])
    table.row({row["measure"], fixed(row["same_query_within_scenes"], 2), fixed(row["same_query_all"], 2),
               fixed(row["own_query_within_scenes"], 2), fixed(row["own_query_all"], 2)});
  return table.text();
}

std::string tree_quality(const char* file) {
  const Json run = result(file);
  MarkdownTable table(
      {"method", "SAH cost", "EPO", "sibling overlap", "own visits, mean", "root visits, mean"});
  for (const Json& tree : run["trees"])
    table.row({code(tree["method"].get<std::string>()), rounded(tree["sah"].get<double>()),
               rounded(tree["epo"].get<double>()), fixed(tree["sibling_overlap"], 2),
               rounded(tree["own_visits"]["mean"].get<double>()),
               rounded(tree["root_visits"]["mean"].get<double>())});
  return table.text();
}

std::string tree_quality_scaled() { return tree_quality("epyc-2-cores/bvh-50000-scaled.json"); }
std::string tree_quality_paper() { return tree_quality("epyc-2-cores/bvh-20000-paper.json"); }

std::string solvers() {
  MarkdownTable table({"solver", "settings", "step, ms (p5 to p95)", "ratio to `soft_step` (p5 to p95)",
                       "overlap, r.m.s.", "max. overlap, m", "kinetic energy, J", "speed, r.m.s., m/s"});
  const Json suite = result("epyc-2-cores/solvers-5000-pile.json");
  for (const Json& row : suite["rows"])
    table.row({row["solver"], row["settings"], spread(row["step_ms"], 2), spread(row["ratio"], 2),
               fmt::format("{:.2g} %", 100 * row["overlap_rms"].get<double>()),
               fmt::format("{:.2g}", row["max_penetration"].get<double>()),
               fmt::format("{:.2g}", row["kinetic_energy"].get<double>()),
               fmt::format("{:.2g}", row["speed_rms"].get<double>())});
  return table.text();
}

std::string frames(const Cells& files) {
  MarkdownTable table(
      {"N, variant", "pairs", "layers", "frames", "frames/s", "frame, ms (p5 to p95)", "parts, ms (share)"});
  for (const std::string& file : files) {
    const Json run = result(file);
    std::string parts;
    for (const Json& part : run["parts"])
      parts += fmt::format("{}{} {} ({} %)", parts.empty() ? "" : ", ", part["name"].get<std::string>(),
                           fixed(part["median_ms"], 2), fixed(100 * part["share"].get<double>(), 0));
    Json frame = run["frame"];
    frame["median"] = frame["median_ms"], frame["p5"] = frame["p5_ms"], frame["p95"] = frame["p95_ms"];
    table.row({size_and_variant(run), count(run["pairs"]["aabb"]), code(run["layers"].get<std::string>()),
               count(run["frames"]), fixed(run["frames_per_second"], 1), spread(frame, 2), parts});
  }
  return table.text();
}

std::string frames_of_impulse() {
  return frames({"nvidia-h200/frames-1000000-spheres.json", "nvidia-h200/frames-100000-all-layers.json",
                 "nvidia-h200/frames-100000-all-layers-panels.json"});
}
std::string frames_of_soft_step() {
  return frames({"nvidia-h200/default-frames-1000000-spheres.json",
                 "nvidia-h200/default-frames-100000-all-layers.json"});
}
std::string frames_of_cpu() {
  return frames({"epyc-2-cores/frames-2000-paper.json", "epyc-2-cores/frames-100000-scaled.json"});
}

std::string interval(const Json& estimate) {
  return fmt::format("{} ({} to {})", fixed(estimate["ratio"], 3), fixed(estimate["low"], 3),
                     fixed(estimate["high"], 3));
}

std::string effects(const char* file) {
  MarkdownTable table({"effect", "off: launches, buffers, hash", "step, ms", "off, ratio (95 % interval)",
                       "on, ratio (95 % interval)", "on: launches", "on: KiB", "on: hash"});
  const Json suite = result(file);
  for (const Json& row : suite["effects"]) {
    int launches = 0;
    for (const auto& [stage, n] : row["on"]["launches"].items()) launches += n.get<int>();
    for (const auto& [stage, n] : row["off"]["launches"].items()) launches -= n.get<int>();
    const double bytes =
        row["on"]["allocated_bytes"].get<double>() - row["off"]["allocated_bytes"].get<double>();
    table.row({code(row["effect"].get<std::string>()),
               row["off_costs_nothing"].get<bool>() ? "same" : "differ", fixed(row["step_ms"]["median"], 3),
               interval(row["off_estimate"]), interval(row["on_estimate"]), fmt::format("{:+}", launches),
               fmt::format("{:+.1f}", bytes / 1024),
               row["on"]["state_hash"] == row["off"]["state_hash"] ? "unchanged" : "changed"});
  }
  return table.text();
}

std::string effects_of_cpu() { return effects("epyc-2-cores/effects-5000-scaled.json"); }
std::string effects_of_h200() { return effects("nvidia-h200/effects-100000-scaled.json"); }
std::string effects_of_h200_small() { return effects("nvidia-h200/effects-2001-scaled.json"); }

const std::map<std::string_view, std::string (*)()> tables{
    {"steps", steps},
    {"steps-impulse", steps_of_impulse},
    {"stages-impulse", stages_of_impulse},
    {"stages-friction", stages_with_friction},
    {"one-large-body", one_large_body},
    {"broad-phases-scaled", broad_phases_scaled},
    {"broad-phases-variants", broad_phases_variants},
    {"growth", growth},
    {"predictors", predictors},
    {"tree-quality-scaled", tree_quality_scaled},
    {"tree-quality-paper", tree_quality_paper},
    {"solvers", solvers},
    {"frames-impulse", frames_of_impulse},
    {"frames-soft_step", frames_of_soft_step},
    {"frames-cpu", frames_of_cpu},
    {"effects-cpu", effects_of_cpu},
    {"effects-h200", effects_of_h200},
    {"effects-h200-small", effects_of_h200_small},
};

}  // namespace

std::vector<std::string_view> result_table_names() {
  std::vector<std::string_view> names;
  for (const auto& [name, make] : tables) names.push_back(name);
  return names;
}

std::string result_table(std::string_view name) {
  const auto found = tables.find(name);
  if (found == tables.end()) throw InputError(fmt::format("results {}: unknown table", name));
  return found->second();
}

}  // namespace collidoscope
