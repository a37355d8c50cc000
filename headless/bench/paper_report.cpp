#include "headless/bench/paper_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "headless/pictures/chart_picture.h"
#include "headless/reporting/report.h"
#include "sim_cuda/core/physics_version.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;
using PaperRows = std::vector<PaperRow>;

/// The row of the same table, N and query at the table's first shape.
const PaperRow& first_of(const PaperRows& rows, const PaperRow& row) {
  return *std::ranges::find_if(rows, [&](const PaperRow& r) {
    return r.cell.table == row.cell.table && r.cell.bodies == row.cell.bodies && r.query == row.query;
  });
}

double paper_ms(const PaperRow& row) { return row.cell.paper_ms; }
double our_ms(const PaperRow& row) { return row.ms.median; }
double build_ms(const PaperRow& row) { return row.timing.build_stage.median; }
double sort_ms(const PaperRow& row) { return row.timing.sort_stage.median; }
double unsorted_ms(const PaperRow& row) { return row.ms.median - row.timing.sort_stage.median; }

double speed_up(const PaperRows& rows, const PaperRow& row, double (*ms)(const PaperRow&)) {
  return ms(first_of(rows, row)) / ms(row);
}

/// Speed-up divided by the increase of B T, relative to the table's first shape.
double efficiency(const PaperRows& rows, const PaperRow& row, double (*ms)(const PaperRow&)) {
  const PaperCell& first = first_of(rows, row).cell;
  return speed_up(rows, row, ms) * first.blocks * first.threads / (row.cell.blocks * row.cell.threads);
}

/// Median efficiency of Table 5 without its first shape; 0 without rows.
double median_efficiency(const PaperRows& rows, PaperQuery query, double (*ms)(const PaperRow&)) {
  std::vector<float> values;
  for (const PaperRow& row : rows)
    if (row.cell.table == 5 && row.query == query && row.cell.blocks * row.cell.threads > 8)
      values.push_back(static_cast<float>(efficiency(rows, row, ms)));
  return percentiles_of(values).median;
}

const PaperRow* find(const PaperRows& rows, PaperQuery query, int table, std::int64_t bodies, int blocks,
                     int threads) {
  const auto row = std::ranges::find_if(rows, [&](const PaperRow& r) {
    return r.query == query && r.cell.table == table && r.cell.bodies == bodies && r.cell.blocks == blocks &&
           r.cell.threads == threads;
  });
  return row == rows.end() ? nullptr : &*row;
}

const char* outcome(bool holds) { return holds ? "confirmed" : "not confirmed"; }

void add_efficiency(const PaperRows& rows, PaperQuery query, std::vector<std::string>& lines) {
  const double ours = median_efficiency(rows, query, our_ms);
  if (!(ours > 0)) return;
  constexpr double claimed = 0.8;
  lines.push_back(fmt::format(
      "\"Efficiency of 80 % in most cases\" (Table 5, {} queries, median above 8 threads): paper {:.1f} %, "
      "measured {:.1f} %: {}.",
      name_of(query), 100 * median_efficiency(rows, query, paper_ms), 100 * ours, outcome(ours >= claimed)));
  const double sort = median_efficiency(rows, query, sort_ms),
               rest = median_efficiency(rows, query, unsorted_ms);
  lines.push_back(
      fmt::format("\"The sorting algorithm seems to be the main factor that eats up the speedup\" ({} "
                  "queries): measured efficiency of the sort {:.1f} %, of the other stages {:.1f} %: {}.",
                  name_of(query), 100 * sort, 100 * rest, outcome(sort < 0.9 * rest)));
}

void add_comparison(const PaperRows& rows, PaperQuery query, const std::string& what,
                    double (*ms)(const PaperRow&), std::vector<std::string>& lines) {
  int faster = 0, compared = 0;
  double least = 1e30, most = 0;
  for (const auto& [blocks, threads] : paper_shapes) {
    const PaperRow* down = find(rows, query, 3, 10000, blocks, threads);
    const PaperRow* up = find(rows, query, 4, 10000, blocks, threads);
    if (down == nullptr || up == nullptr) continue;
    ++compared;
    faster += ms(*up) < ms(*down);
    least = std::min(least, ms(*down) / ms(*up));
    most = std::max(most, ms(*down) / ms(*up));
  }
  if (compared == 0) return;
  lines.push_back(fmt::format(
      "\"Bottom-up is faster than top-down\" (Tables 3 and 4, N = 10,000), {}: measured in {} of {} "
      "launch shapes; top-down takes {:.2f} to {:.2f} times as long (paper: 2.4 to 6.9): {}.",
      what, faster, compared, least, most, faster == 0 ? "refuted" : outcome(faster == compared)));
}

std::vector<std::string> claims(const PaperResults& results) {
  const PaperRows& rows = results.rows;
  std::vector<std::string> lines;
  for (const PaperQuery query : {PaperQuery::whole, PaperQuery::half}) add_efficiency(rows, query, lines);
  for (const PaperQuery query : {PaperQuery::whole, PaperQuery::half})
    add_comparison(rows, query, fmt::format("collision handling, {} queries", name_of(query)), our_ms, lines);
  add_comparison(rows, PaperQuery::whole, "tree build only", build_ms, lines);
  if (const PaperRow* row = find(rows, PaperQuery::none, 1, 5000, 8, 64)) {
    const double tests = 5000.0 * 4999 / 2;
    lines.push_back(
        fmt::format("Table 1, time per tested pair with 512 threads: paper {:.1f} ns, measured {:.2f} ns.",
                    1e6 * row->cell.paper_ms / tests, 1e6 * row->ms.median / tests));
  }
  if (const PaperRow* row = find(rows, PaperQuery::whole, 4, 50000, 2, 4)) {
    const double pairs = static_cast<double>(row->timing.pairs);
    lines.push_back(fmt::format(
        "Table 4, thread time per pair (N = 50,000, 8 threads; tree, query and response): paper "
        "{:.2f} us for the number of pairs measured here, or {:.0f} cycles of its GPU, which is less "
        "than one memory read; measured {:.1f} us. So the paper's run had fewer pairs.",
        1e3 * 8 * row->cell.paper_ms / pairs, 8 * row->cell.paper_ms * 1'072'000 / pairs,
        1e3 * 8 * row->ms.median / pairs));
  }
  for (const PaperRecursion& r : results.recursions)
    lines.push_back(fmt::format(
        "\"At least 5x performance\" by a stack instead of recursion (N = {}, {}, whole queries): the query "
        "takes {:.4f} ms with a stack and {:.4f} ms with recursive calls, {:.2f} times as long: {}.",
        grouped(r.bodies),
        r.shape.blocks > 0 ? fmt::format("B {}, T {}", r.shape.blocks, r.shape.threads) : "B and T auto",
        r.stack_ms.median, r.calls_ms.median, r.calls_ms.median / r.stack_ms.median,
        outcome(r.calls_ms.median >= 5 * r.stack_ms.median)));
  return lines;
}

std::string table_text(const PaperRows& rows, int table, bool markdown) {
  std::string text =
      markdown ? fmt::format(
                     "**{}**\n\n| N | B | T | query | ms, paper | S | ms, measured (p5 to p95) | S | "
                     "efficiency | pairs | bytes | launches |\n"
                     "|---:|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
                     paper_table_title(table))
               : fmt::format(
                     "{}\n{:>8}{:>4}{:>4} {:<6}{:>11}{:>7}{:>13}{:>11}{:>11}{:>7}{:>12}{:>11}{:>14}{:>9}\n",
                     paper_table_title(table), "N", "B", "T", "query", "ms, paper", "S", "ms, measured", "p5",
                     "p95", "S", "efficiency", "pairs", "bytes", "launches");
  for (const PaperRow& r : rows) {
    if (r.cell.table != table) continue;
    const double theirs = speed_up(rows, r, paper_ms), ours = speed_up(rows, r, our_ms),
                 share = 100 * efficiency(rows, r, our_ms);
    const char* query = r.query == PaperQuery::none ? "" : name_of(r.query);
    text += markdown ? fmt::format(
                           "| {} | {} | {} | {} | {:.4f} | {:.2f} | {:.4f} ({:.4f} to {:.4f}) | {:.2f} | "
                           "{:.0f} % | {} | {} | {} |\n",
                           grouped(r.cell.bodies), r.cell.blocks, r.cell.threads, query, r.cell.paper_ms,
                           theirs, r.ms.median, r.ms.p5, r.ms.p95, ours, share, grouped(r.timing.pairs),
                           grouped(r.timing.bytes), r.timing.launches)
                     : fmt::format(
                           "{:>8}{:>4}{:>4} {:<6}{:>11.4f}{:>7.2f}{:>13.4f}{:>11.4f}{:>11.4f}{:>7.2f}"
                           "{:>10.0f} %{:>11}{:>14}{:>9}\n",
                           grouped(r.cell.bodies), r.cell.blocks, r.cell.threads, query, r.cell.paper_ms,
                           theirs, r.ms.median, r.ms.p5, r.ms.p95, ours, share, grouped(r.timing.pairs),
                           grouped(r.timing.bytes), r.timing.launches);
  }
  return text + "\n";
}

}  // namespace

const char* name_of(PaperQuery query) {
  return query == PaperQuery::whole ? "whole" : query == PaperQuery::half ? "half" : "none";
}

std::string paper_text(const PaperResults& results, bool markdown) {
  std::string text =
      results.device +
      "; paper: NVIDIA GTX 940M. S: speed-up relative to the first launch shape of the same N and query.\n"
      "Query whole: each body finds all its overlaps, as in the paper; half: each pair is found once.\n\n";
  for (int table = 1; table <= 5; ++table)
    if (std::ranges::find(results.rows, table, [](const PaperRow& r) { return r.cell.table; }) !=
        results.rows.end())
      text += table_text(results.rows, table, markdown);
  for (const std::string& line : claims(results)) text += line + (markdown ? "\n\n" : "\n");
  return text;
}

std::string paper_json(const PaperResults& results) {
  const PaperRows& rows = results.rows;
  Json json{{"suite", "paper"},
            {"physics_version", physics_version},
            {"device", results.device},
            {"rows", Json::array()}};
  for (const PaperRow& r : rows)
    json["rows"].push_back({{"table", r.cell.table},
                            {"bodies", r.cell.bodies},
                            {"blocks", r.cell.blocks},
                            {"threads", r.cell.threads},
                            {"query", r.query == PaperQuery::none ? Json(nullptr) : Json(name_of(r.query))},
                            {"paper_ms", r.cell.paper_ms},
                            {"ms", r.ms.median},
                            {"p5_ms", r.ms.p5},
                            {"p95_ms", r.ms.p95},
                            {"speed_up_paper", speed_up(rows, r, paper_ms)},
                            {"speed_up", speed_up(rows, r, our_ms)},
                            {"efficiency", efficiency(rows, r, our_ms)},
                            {"sort_ms", r.timing.sort_stage.median},
                            {"build_ms", r.timing.build_stage.median},
                            {"pairs_ms", r.timing.pairs_stage.median},
                            {"step_median_ms", r.timing.whole_step},
                            {"pairs", r.timing.pairs},
                            {"launches", r.timing.launches},
                            {"allocated_bytes", r.timing.bytes},
                            {"key_bits", r.timing.key_bits > 0 ? Json(r.timing.key_bits) : Json(nullptr)},
                            {"steps", r.timing.steps},
                            {"timed_steps", r.timing.timed}});
  json["recursion"] = Json::array();
  for (const PaperRecursion& r : results.recursions)
    json["recursion"].push_back({{"bodies", r.bodies},
                                 {"blocks", r.shape.blocks},
                                 {"threads", r.shape.threads},
                                 {"stack_ms", r.stack_ms.median},
                                 {"stack_p5_ms", r.stack_ms.p5},
                                 {"stack_p95_ms", r.stack_ms.p95},
                                 {"calls_ms", r.calls_ms.median},
                                 {"calls_p5_ms", r.calls_ms.p5},
                                 {"calls_p95_ms", r.calls_ms.p95}});
  json["claims"] = claims(results);
  return json_text(json);
}

std::string paper_csv(const PaperResults& results) {
  std::string text =
      "table,bodies,blocks,threads,query,paper_ms,ms,p5_ms,p95_ms,speed_up_paper,speed_up,efficiency,sort_ms,"
      "build_ms,pairs,launches,allocated_bytes,timed_steps\n";
  for (const PaperRow& r : results.rows)
    text += fmt::format(
        "{},{},{},{},{},{},{:.6f},{:.6f},{:.6f},{:.3f},{:.3f},{:.3f},{:.6f},{:.6f},{},{},{},{}\n",
        r.cell.table, r.cell.bodies, r.cell.blocks, r.cell.threads, name_of(r.query), r.cell.paper_ms,
        r.ms.median, r.ms.p5, r.ms.p95, speed_up(results.rows, r, paper_ms),
        speed_up(results.rows, r, our_ms), efficiency(results.rows, r, our_ms), r.timing.sort_stage.median,
        r.timing.build_stage.median, r.timing.pairs, r.timing.launches, r.timing.bytes, r.timing.timed);
  return text;
}

Chart paper_chart(const PaperResults& results) {
  Chart chart;
  chart.title = "Speed-up of a step against the number of threads (Table 5, bottom-up tree, whole queries)";
  chart.note = results.device + "; dashed: paper, NVIDIA GTX 940M";
  chart.x = {"number of threads, B T", short_number, true};
  chart.y = {"speed-up over 2 blocks of 4 threads", short_number, true};
  ChartSeries ideal{"linear", 0xff888888, {{8, 1}, {256, 32}}};
  ideal.marks = false;
  chart.series.push_back(ideal);
  for (const bool of_paper : {false, true})
    for (const PaperRow& r : results.rows) {
      if (r.cell.table != 5 || r.query != PaperQuery::whole) continue;
      const std::string name = fmt::format("N = {}{}", grouped(r.cell.bodies), of_paper ? ", paper" : "");
      auto series = std::ranges::find(chart.series, name, &ChartSeries::name);
      if (series == chart.series.end()) {
        chart.series.push_back({name, 0, {}, true, of_paper, !of_paper});
        series = chart.series.end() - 1;
        series->color = chart_color(chart.series.size() - 2);
        for (const ChartSeries& ours : chart.series)
          if (of_paper && name.starts_with(ours.name + ",")) series->color = ours.color;
      }
      series->points.push_back({static_cast<double>(r.cell.blocks * r.cell.threads),
                                speed_up(results.rows, r, of_paper ? paper_ms : our_ms)});
    }
  return chart;
}

}  // namespace collidoscope
