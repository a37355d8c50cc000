#include "headless/bvh_boxes.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/percentiles.h"
#include "headless/reporting/percentiles_json.h"
#include "headless/reporting/report.h"
#include "headless/tree_table.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/import/box_file.h"
#include "sim_cuda/import/tree_file.h"
#include "sim_cuda/run/box_query.h"
#include "sim_cuda/run/given_tree.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
/// s. Methods that compare all pairs are left out, unless they are asked for, if they would take longer.
constexpr double longest_comparison = 10;

struct MeasuredMethod {
  std::string name;
  Percentiles whole;  ///< us, from boxes to the ordered list of pairs
  std::int64_t pairs = 0, bytes = 0;
  PairDifference difference;  ///< from the reference
  bool agrees() const { return difference.missing == 0 && difference.excess == 0; }
};

bool compares_all(const std::string& name) {
  const BroadPhaseMethod* const method = find_broad_phase(name);
  return method != nullptr && (method->ns_of_comparison > 0 || name == "bvh_input_order");
}

/// s, of one search by brute force.
double comparison_seconds(std::size_t boxes, double equal_cores) {
  const auto n = static_cast<double>(boxes);
  return 1e-9 * find_broad_phase("brute_force")->ns_of_comparison * n * (n - 1) / 2 / equal_cores;
}

std::string examples_text(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  std::string text;
  for (const auto& [a, b] : pairs) text += fmt::format("{}{}-{}", text.empty() ? "" : ", ", a, b);
  return text;
}

std::string difference_text(const PairDifference& difference) {
  std::string text;
  if (difference.missing > 0)
    text += fmt::format("{} missing, such as {}", grouped(difference.missing),
                        examples_text(difference.missing_examples));
  if (difference.excess > 0)
    text += fmt::format("{}{} in excess, such as {}", text.empty() ? "" : "; ", grouped(difference.excess),
                        examples_text(difference.excess_examples));
  return text;
}

Json json_of(const MeasuredMethod& method) {
  const auto list = [](const auto& pairs) {
    Json json = Json::array();
    for (const auto& [a, b] : pairs) json.push_back({a, b});
    return json;
  };
  Json json{{"method", method.name},
            {"whole_us", percentiles_json(method.whole)},
            {"pairs", method.pairs},
            {"bytes", method.bytes},
            {"agrees", method.agrees()}};
  if (!method.agrees())
    json["difference"] = {{"missing", method.difference.missing},
                          {"missing_examples", list(method.difference.missing_examples)},
                          {"excess", method.difference.excess},
                          {"excess_examples", list(method.difference.excess_examples)}};
  return json;
}

std::string table_of(const std::vector<MeasuredMethod>& methods, const std::string& reference) {
  std::string text = fmt::format("  {:<20}{:>14}{:>16}{:>14}  same pairs as {}\n", "method", "whole, us",
                                 "pairs", "bytes", reference);
  for (const MeasuredMethod& method : methods)
    text += fmt::format("  {:<20}{:>14.1f}{:>16}{:>14}  {}\n", method.name, method.whole.median,
                        grouped(method.pairs), grouped(method.bytes),
                        method.agrees() ? "yes" : "NO: " + difference_text(method.difference));
  return text + "  whole: from boxes to the ordered list of pairs, median\n";
}

}  // namespace

int bvh_of_boxes(const Options& options) {
  if (options.steps || !options.overrides.settings.empty())
    throw InputError("--boxes: boxes cannot be simulated; remove --steps and the settings of the simulation");
  const std::vector<Aabb> boxes = read_boxes(options.bench.boxes);
  std::optional<GivenTree> given;
  if (!options.bench.tree.empty()) given = read_tree(options.bench.tree, boxes);
  std::optional<OutputFile> file;
  if (!options.json.empty() && options.json != "-") file.emplace("--json", options.json);

  std::vector<std::string> names = broad_phase_names(options.run.executor);
  const bool asked = !options.bench.methods.empty();
  const double cores = BoxQuery(options.run, {boxes[0]}).equal_cores();
  const double seconds = comparison_seconds(boxes.size(), cores);
  std::string reference = "brute_force";
  if (seconds > longest_comparison) {
    std::erase_if(names, compares_all);
    reference = (asked ? options.bench.methods : names)[0];
    fmt::print(stderr,
               "note: to compare all boxes with each other would take about {:.0f} s; the pairs are compared "
               "with those of {}\n",
               seconds, reference);
  }
  if (asked) names = options.bench.methods;

  const auto query_of = [&](const std::string& name) {
    RunOptions run = options.run;
    run.broad_phase = name;
    return std::make_unique<BoxQuery>(run, boxes);
  };
  const BoxPairs expected = query_of(reference)->find();
  std::vector<MeasuredMethod> methods;
  std::vector<MeasuredTree> trees;
  if (given) trees.push_back({.method = "given tree", .quality = quality_of(*given, options.run)});
  std::string device;
  {
    Progress progress("methods", std::ssize(names));
    for (const std::string& name : names) {
      const std::unique_ptr<BoxQuery> query = query_of(name);
      const BoxPairs found = query->find();
      const BroadPhaseTimes times = query->time(static_cast<int>(options.bench.repeats));
      MeasuredMethod& method = methods.emplace_back();
      method = {.name = name,
                .whole = percentiles_of(times.whole),
                .pairs = std::ssize(found.second),
                .bytes = query->method_bytes(),
                .difference = compare_pairs(expected, found)};
      for (double* ms : {&method.whole.median, &method.whole.p5, &method.whole.p95}) *ms *= 1000;
      if (query->has_tree()) {
        MeasuredTree& tree = trees.emplace_back();
        tree.method = name;
        tree.key_bits = has_morton_keys(name) ? query->key_bits() : 0;
        tree.quality = query->quality();
        tree.take(times);
      }
      device = query->device_name();
      progress.update(std::ssize(methods));
    }
  }
  Json json{{"boxes", options.bench.boxes},    {"count", boxes.size()},  {"device", device},
            {"pairs", expected.second.size()}, {"reference", reference}, {"methods", Json::array()},
            {"trees", Json::array()}};
  for (const MeasuredMethod& method : methods) json["methods"].push_back(json_of(method));
  for (const MeasuredTree& tree : trees) json["trees"].push_back(json_of(tree));
  if (file) {
    file->write(json_text(json));
    file->commit();
  }
  if (options.json == "-")
    print(json_text(json));
  else
    print(fmt::format("{}: {} boxes, {} pairs, on {}\n\n{}\n{}", options.bench.boxes,
                      grouped(std::ssize(boxes)), grouped(std::ssize(expected.second)), device,
                      table_of(methods, reference), trees.empty() ? "" : text_of(trees)));
  return std::ranges::all_of(methods, &MeasuredMethod::agrees) ? 0 : 1;
}

}  // namespace collidoscope
