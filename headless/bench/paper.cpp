#include "headless/bench/paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>

#include "headless/bench/result_files.h"
#include "headless/bench/spread.h"
#include "headless/chart_picture.h"
#include "headless/progress.h"
#include "headless/report.h"
#include "headless/standard_output.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

/// A cell of a table: its figure on an NVIDIA GTX 940M (384 shading units, 1,072 MHz), CUDA 8.0.
struct Cell {
  int table;
  std::int64_t bodies;
  int blocks, threads;
  double paper_ms;
};

constexpr std::array<std::array<int, 2>, 6> shapes{{{2, 4}, {4, 4}, {4, 8}, {8, 8}, {8, 16}, {16, 16}}};

constexpr std::array<Cell, 8> table_1{{{1, 100, 16, 16, 0.2933},
                                       {1, 100, 8, 64, 0.1859},
                                       {1, 500, 16, 16, 5.3388},
                                       {1, 500, 8, 64, 2.8176},
                                       {1, 1000, 16, 16, 21.8844},
                                       {1, 1000, 8, 64, 11.0379},
                                       {1, 5000, 16, 16, 534.405},
                                       {1, 5000, 8, 64, 273.7910}}};

struct Rows {
  int table;
  std::int64_t bodies;
  std::array<double, 6> ms;  ///< by shapes
};
constexpr std::array<Rows, 13> other_tables{
    {{2, 1000, {0.122720, 0.071584, 0.032768, 0.019296, 0.013248, 0.009472}},
     {2, 5000, {0.535296, 0.266784, 0.145792, 0.085216, 0.052512, 0.024456}},
     {2, 10000, {1.05216, 0.536256, 0.268928, 0.149824, 0.088224, 0.042528}},
     {2, 50000, {6.19203, 3.09773, 1.57142, 0.795168, 0.408704, 0.218240}},
     {3, 10000, {22.83467, 13.57422, 9.623959, 6.859251, 4.478128, 3.148109}},
     {4, 1000, {1.02256, 0.600480, 0.383522, 0.195681, 0.136486, 0.103849}},
     {4, 5000, {4.88496, 2.50912, 1.40656, 0.738243, 0.456867, 0.240884}},
     {4, 10000, {9.46384, 4.87392, 2.59872, 1.41523, 0.775528, 0.457289}},
     {4, 50000, {56.4363, 28.3112, 14.5653, 7.55952, 4.01712, 2.16896}},
     {5, 1000, {1.14528, 0.672064, 0.41629, 0.214977, 0.149734, 0.113321}},
     {5, 5000, {5.420256, 2.775904, 1.552352, 0.823459, 0.509379, 0.26534}},
     {5, 10000, {10.516, 5.410176, 2.867648, 1.565054, 0.863752, 0.499817}},
     {5, 50000, {62.62833, 31.40893, 16.13672, 8.354688, 4.425824, 2.3872}}}};

std::vector<Cell> cells() {
  std::vector<Cell> all(table_1.begin(), table_1.end());
  for (const Rows& row : other_tables)
    for (std::size_t k = 0; k < shapes.size(); ++k)
      all.push_back({row.table, row.bodies, shapes[k][0], shapes[k][1], row.ms[k]});
  return all;
}

const char* title(int table) {
  constexpr std::array names{"",
                             "Table 1: every pair by brute force",
                             "Table 2: dynamics forwarding",
                             "Table 3: collision handling, tree built top-down from a work queue",
                             "Table 4: collision handling, tree built bottom-up",
                             "Table 5: forwarding and collision handling, tree built bottom-up"};
  return names[static_cast<std::size_t>(table)];
}

/// What the first steps of one (method, N, B, T) took; each shape of one N goes through the same ones.
struct Timing {
  double forwarding = 0, collisions = 0;  ///< ms, sums of stage medians
  double pairs_stage = 0, sort_stage = 0, build_stage = 0;
  double whole = 0;  ///< ms, plain steps
  std::int64_t pairs = 0, bytes = 0;
  int launches = 0, steps = 0;
};

constexpr int most_steps = 40;

/// `steps` 0: as many as take two seconds, 40 at most.
Timing time_steps(Scene scene, RunOptions run, const char* method, std::int64_t bodies, LaunchShape shape,
                  int steps) {
  scene.generators[0].count = bodies;
  run.broad_phase = method;
  run.shape = shape;
  if (run.sort == SortMethod::automatic) run.sort = SortMethod::radix;  // the paper's
  World world(scene, run);
  const auto start = std::chrono::steady_clock::now();
  // Every other step is timed stage by stage; a slow one need not be repeated often.
  do world.step(2);
  while (world.steps() < (steps > 0 ? steps : most_steps) &&
         (steps > 0 || std::chrono::steady_clock::now() - start < std::chrono::seconds(2)));
  const RunTimes times = world.times();
  Timing timing;
  timing.whole = times.step_median_ms;
  for (const StageTime& stage : times.stages) {
    (stage.name == "move" ? timing.forwarding : timing.collisions) += stage.median_ms;
    if (stage.name == "pairs") timing.pairs_stage = stage.median_ms;
    if (stage.name == "sort") timing.sort_stage = stage.median_ms;
    if (stage.name == "build") timing.build_stage = stage.median_ms;
    timing.launches += stage.launches;
  }
  timing.pairs = world.measure().pairs;
  timing.bytes = world.allocated_bytes();
  timing.steps = static_cast<int>(world.steps());
  return timing;
}

struct Row {
  Cell cell;
  double ms;
  Timing timing;
};

/// The query of the same tree by a stack and by calls.
struct Recursion {
  std::int64_t bodies;
  LaunchShape shape;
  double stack_ms, calls_ms;
};

double speed_up(const std::vector<Row>& rows, const Row& row, bool of_paper) {
  for (const Row& first : rows)
    if (first.cell.table == row.cell.table && first.cell.bodies == row.cell.bodies)
      return of_paper ? first.cell.paper_ms / row.cell.paper_ms : first.ms / row.ms;
  return 1;
}

double paper_ms(const Row& row) { return row.cell.paper_ms; }
double our_ms(const Row& row) { return row.ms; }
double build_ms(const Row& row) { return row.timing.build_stage; }
double sort_ms(const Row& row) { return row.timing.sort_stage; }
double unsorted_ms(const Row& row) { return row.ms - row.timing.sort_stage; }

/// Speed-up over the growth of B T, against the table's first shape.
double efficiency(const std::vector<Row>& rows, const Row& row, double (*ms)(const Row&)) {
  for (const Row& first : rows)
    if (first.cell.table == row.cell.table && first.cell.bodies == row.cell.bodies)
      return ms(first) / ms(row) * first.cell.blocks * first.cell.threads /
             (row.cell.blocks * row.cell.threads);
  return 1;
}

double median_efficiency(const std::vector<Row>& rows, int table, double (*ms)(const Row&)) {
  std::vector<float> values;
  for (const Row& row : rows)
    if (row.cell.table == table && row.cell.blocks * row.cell.threads > 8)
      values.push_back(static_cast<float>(efficiency(rows, row, ms)));
  return spread_of(values).median;
}

const Row* find(const std::vector<Row>& rows, int table, std::int64_t bodies, int blocks, int threads) {
  for (const Row& row : rows)
    if (row.cell.table == table && row.cell.bodies == bodies && row.cell.blocks == blocks &&
        row.cell.threads == threads)
      return &row;
  return nullptr;
}

std::vector<std::string> claims(const std::vector<Row>& rows, const std::vector<Recursion>& recursions) {
  std::vector<std::string> lines;
  const double theirs = median_efficiency(rows, 5, paper_ms), ours = median_efficiency(rows, 5, our_ms);
  if (ours > 0) {
    lines.push_back(fmt::format(
        "\"Efficiency of 80 % in most cases\" (Table 5, median beyond 8 threads): {:.0f} % by its "
        "own figures, {:.0f} % here: {}.",
        100 * theirs, 100 * ours, ours >= 0.7 ? "confirmed" : "not confirmed"));
    const double sort = median_efficiency(rows, 5, sort_ms), rest = median_efficiency(rows, 5, unsorted_ms);
    lines.push_back(fmt::format(
        "\"The sorting algorithm seems to be the main factor that eats up the speedup\": {:.0f} % "
        "efficient is the sort here, {:.0f} % all the rest: {}.",
        100 * sort, 100 * rest, sort < 0.9 * rest ? "confirmed" : "not confirmed"));
  }
  for (const auto& [what, ms] :
       {std::pair{"collision handling", &our_ms}, std::pair{"building alone", &build_ms}}) {
    int faster = 0, compared = 0;
    double least = 1e30, most = 0;
    for (const auto& [blocks, threads] : shapes) {
      const Row* down = find(rows, 3, 10000, blocks, threads);
      const Row* up = find(rows, 4, 10000, blocks, threads);
      if (down == nullptr || up == nullptr) continue;
      ++compared;
      faster += ms(*up) < ms(*down);
      least = std::min(least, ms(*down) / ms(*up));
      most = std::max(most, ms(*down) / ms(*up));
    }
    if (compared > 0)
      lines.push_back(fmt::format(
          "\"Bottom-up is faster than top-down\" (Tables 3 and 4, N = 10,000), {}: in {} of {} shapes "
          "here; top-down takes {:.2f} to {:.2f} times as long (in the paper 2.4 to 6.9): {}.",
          what, faster, compared, least, most,
          faster == compared ? "confirmed"
          : faster == 0      ? "refuted"
                             : "not confirmed"));
  }
  if (const Row* row = find(rows, 1, 5000, 8, 64)) {
    const double tests = 5000.0 * 4999 / 2;
    lines.push_back(fmt::format(
        "Table 1 implies {:.1f} ns a pair tested by its 512 threads in the paper, {:.2f} ns here.",
        1e6 * row->cell.paper_ms / tests, 1e6 * row->ms / tests));
  }
  if (const Row* row = find(rows, 4, 50000, 2, 4))
    lines.push_back(
        fmt::format("Table 4 implies {:.2f} us of one thread for each of our pairs (N = 50,000, 8 threads: "
                    "tree, query and "
                    "response), {:.0f} cycles of that chip, less than one read of its memory takes; here "
                    "{:.1f} us. So many "
                    "pairs the paper cannot have had.",
                    1e3 * 8 * row->cell.paper_ms / static_cast<double>(row->timing.pairs),
                    8 * row->cell.paper_ms * 1'072'000 / static_cast<double>(row->timing.pairs),
                    1e3 * 8 * row->ms / static_cast<double>(row->timing.pairs)));
  for (const Recursion& r : recursions)
    lines.push_back(fmt::format(
        "\"At least 5x performance\" by a stack in place of recursion (N = {}, {}): the query takes {:.4f} "
        "ms "
        "with a stack, {:.4f} by calls, {:.2f} times as long: {}.",
        grouped(r.bodies),
        r.shape.blocks > 0 ? fmt::format("B {}, T {}", r.shape.blocks, r.shape.threads) : "B and T auto",
        r.stack_ms, r.calls_ms, r.calls_ms / r.stack_ms,
        r.calls_ms >= 5 * r.stack_ms ? "confirmed" : "not confirmed"));
  return lines;
}

std::string table_text(const std::vector<Row>& rows, int table, bool markdown) {
  std::string text =
      markdown ? fmt::format(
                     "**{}**\n\n| N | B | T | ms, paper | S | ms, here | S | efficiency | pairs |\n"
                     "|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
                     title(table))
               : fmt::format("{}\n{:>8}{:>5}{:>5}{:>13}{:>8}{:>13}{:>8}{:>12}{:>12}\n", title(table), "N",
                             "B", "T", "ms, paper", "S", "ms, here", "S", "efficiency", "pairs");
  for (const Row& r : rows) {
    if (r.cell.table != table) continue;
    const std::string theirs = fmt::format("{:.2f}", speed_up(rows, r, true)),
                      ours = fmt::format("{:.2f}", speed_up(rows, r, false)),
                      share = fmt::format("{:.0f} %", 100 * efficiency(rows, r, our_ms));
    if (markdown)
      text += fmt::format("| {} | {} | {} | {:.4f} | {} | {:.4f} | {} | {} | {} |\n", grouped(r.cell.bodies),
                          r.cell.blocks, r.cell.threads, r.cell.paper_ms, theirs, r.ms, ours, share,
                          grouped(r.timing.pairs));
    else
      text += fmt::format("{:>8}{:>5}{:>5}{:>13.4f}{:>8}{:>13.4f}{:>8}{:>12}{:>12}\n", grouped(r.cell.bodies),
                          r.cell.blocks, r.cell.threads, r.cell.paper_ms, theirs, r.ms, ours, share,
                          grouped(r.timing.pairs));
  }
  return text + "\n";
}

std::string whole_text(const std::vector<Row>& rows, const std::vector<Recursion>& recursions,
                       const std::string& device, bool markdown) {
  std::string text =
      device + "; the paper: NVIDIA GTX 940M. S: speed-up over the first shape of the same N.\n\n";
  for (int table = 1; table <= 5; ++table)
    if (std::ranges::find(rows, table, [](const Row& r) { return r.cell.table; }) != rows.end())
      text += table_text(rows, table, markdown);
  for (const std::string& line : claims(rows, recursions)) text += line + (markdown ? "\n\n" : "\n");
  return text;
}

std::string rows_json(const std::vector<Row>& rows, const std::vector<Recursion>& recursions,
                      const std::string& device) {
  Json json{{"suite", "paper"}, {"device", device}, {"rows", Json::array()}};
  for (const Row& r : rows)
    json["rows"].push_back({{"table", r.cell.table},
                            {"bodies", r.cell.bodies},
                            {"blocks", r.cell.blocks},
                            {"threads", r.cell.threads},
                            {"paper_ms", r.cell.paper_ms},
                            {"ms", r.ms},
                            {"speed_up_paper", speed_up(rows, r, true)},
                            {"speed_up", speed_up(rows, r, false)},
                            {"efficiency", efficiency(rows, r, our_ms)},
                            {"sort_ms", r.timing.sort_stage},
                            {"build_ms", r.timing.build_stage},
                            {"step_median_ms", r.timing.whole},
                            {"pairs", r.timing.pairs},
                            {"launches", r.timing.launches},
                            {"allocated_bytes", r.timing.bytes},
                            {"steps", r.timing.steps}});
  json["recursion"] = Json::array();
  for (const Recursion& r : recursions)
    json["recursion"].push_back({{"bodies", r.bodies},
                                 {"blocks", r.shape.blocks},
                                 {"threads", r.shape.threads},
                                 {"stack_ms", r.stack_ms},
                                 {"calls_ms", r.calls_ms}});
  json["claims"] = claims(rows, recursions);
  return json_text(json);
}

std::string rows_csv(const std::vector<Row>& rows) {
  std::string text =
      "table,bodies,blocks,threads,paper_ms,ms,speed_up_paper,speed_up,efficiency,sort_ms,build_ms,pairs,"
      "launches,"
      "steps\n";
  for (const Row& r : rows)
    text += fmt::format("{},{},{},{},{},{:.6f},{:.3f},{:.3f},{:.3f},{:.6f},{:.6f},{},{},{}\n", r.cell.table,
                        r.cell.bodies, r.cell.blocks, r.cell.threads, r.cell.paper_ms, r.ms,
                        speed_up(rows, r, true), speed_up(rows, r, false), efficiency(rows, r, our_ms),
                        r.timing.sort_stage, r.timing.build_stage, r.timing.pairs, r.timing.launches,
                        r.timing.steps);
  return text;
}

/// Table 5's speed-up over B T: the paper's dashed, ours, and what all of the threads would give.
Chart chart_of(const std::vector<Row>& rows, const std::string& device) {
  Chart chart;
  chart.title = "Speed-up of the whole step over B T threads (Table 5, tree built bottom-up)";
  chart.note = device + "; dashed: the paper's NVIDIA GTX 940M";
  chart.x = {"threads in all, B T", short_number, true};
  chart.y = {"speed-up over 2 blocks of 4", short_number, true};
  ChartSeries ideal{"linear", 0xff888888, {{8, 1}, {256, 32}}};
  ideal.marks = false;
  chart.series.push_back(ideal);
  for (const bool of_paper : {false, true})
    for (const Row& r : rows) {
      if (r.cell.table != 5) continue;
      const std::string name = fmt::format("N = {}{}", grouped(r.cell.bodies), of_paper ? ", paper" : "");
      auto series = std::ranges::find(chart.series, name, &ChartSeries::name);
      if (series == chart.series.end()) {
        chart.series.push_back({name, 0, {}, true, of_paper, !of_paper});
        series = chart.series.end() - 1;
        series->color = chart_color(chart.series.size() - 2);
        for (const ChartSeries& ours : chart.series)
          if (of_paper && name.starts_with(ours.name + ",")) series->color = ours.color;
      }
      series->points.push_back(
          {static_cast<double>(r.cell.blocks * r.cell.threads), speed_up(rows, r, of_paper)});
    }
  return chart;
}

}  // namespace

int bench_paper(const CommandLine& line) {
  const Options& options = line.options;
  Scene scene = load_scene(line);
  if (!options.overrides.solver) scene.physics.solver = Solver::impulse;  // the paper's
  if (scene.generators.size() != 1)
    throw InputError(scene.name +
                     ": bench paper varies the number of bodies: a scene with one generator is needed");
  const ResultFiles files(options);
  std::vector<Cell> wanted = cells();
  if (!options.bench.sizes.empty())
    std::erase_if(wanted, [&](const Cell& cell) {
      return std::ranges::find(options.bench.sizes, cell.bodies) == options.bench.sizes.end();
    });

  std::vector<Row> rows;
  std::map<std::tuple<std::string, std::int64_t, int, int>, Timing>
      known;                          // Tables 2, 4 and 5 share their runs
  std::map<std::int64_t, int> steps;  // by N: the first shape, which is the slowest, decides
  std::string device;
  {
    const World world(scene, options.run);
    device = world.device_name();
  }
  std::vector<Recursion> recursions;
  const auto write = [&] {
    files.write(rows_json(rows, recursions, device), rows_csv(rows),
                whole_text(rows, recursions, device, true));
  };
  const std::int64_t largest = std::ranges::max(wanted, {}, &Cell::bodies).bodies;
  const std::vector<LaunchShape> recursion_shapes{{16, 16}, {0, 0}};
  Progress progress("rows", std::ssize(wanted) + std::ssize(recursion_shapes));
  for (const Cell& cell : wanted) {
    progress.update(std::ssize(rows));
    const char* method = cell.table == 1   ? "brute_force"
                         : cell.table == 3 ? "lbvh_top_down"
                                           : "bvh_bottom_up";
    const auto key = std::tuple(std::string(method), cell.bodies, cell.blocks, cell.threads);
    if (!known.contains(key)) {
      known[key] = time_steps(scene, options.run, method, cell.bodies, {cell.blocks, cell.threads},
                              steps[cell.bodies]);
      steps[cell.bodies] = known[key].steps;
    }
    const Timing& t = known[key];
    const double ms = cell.table == 1   ? t.pairs_stage
                      : cell.table == 2 ? t.forwarding
                      : cell.table == 5 ? t.forwarding + t.collisions
                                        : t.collisions;
    rows.push_back({cell, ms, t});
    write();
  }
  for (const LaunchShape shape : recursion_shapes) {
    progress.update(std::ssize(rows) + std::ssize(recursions));
    const auto query_ms = [&](const char* method) {
      return time_steps(scene, options.run, method, largest, shape, 0).pairs_stage;
    };
    recursions.push_back({largest, shape, query_ms("bvh_bottom_up"), query_ms("bvh_recursive")});
    write();
  }
  files.plot(chart_of(rows, device));
  print(options.json == "-" ? rows_json(rows, recursions, device)
                            : whole_text(rows, recursions, device, false));
  return 0;
}

}  // namespace collidoscope
