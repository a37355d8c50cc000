#include "headless/stability/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <thread>

#include "headless/cli/interruption.h"
#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/stability/stability_readme.h"
#include "headless/stability/stability_report.h"
#include "headless/stability/trial_pool.h"
#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

/// Flags that say nothing together.
void check_flags(const Options& options, const std::vector<std::string>& cases) {
  std::vector<std::string> faults;
  const StabilityOptions& stability = options.stability;
  const Overrides& chosen = options.overrides;
  if (stability.readme.empty() != stability.from.empty())
    faults.emplace_back(stability.from.empty() ? "--readme: --from FILE is missing, what --json wrote"
                                               : "--from: is of --readme FILE, which is missing");
  if (!stability.readme.empty() && (!cases.empty() || stability.plant || !options.json.empty()))
    faults.emplace_back("--readme: runs no trials; leave out cases, --plant and --json");
  if (stability.plant && (chosen.solver || chosen.precision || !stability.save_failures.empty()))
    faults.emplace_back(
        "--plant: faults run with the solver and in the precision of their scenes; leave out --solver, "
        "--precision and --save-failures");
  if (!faults.empty()) throw InputError(faults);
}

ExecutorKind executor_of(const RunOptions& options) {
  std::string why;
  const bool cuda = options.executor != ExecutorKind::cpu && cuda_available(&why);
  if (options.executor == ExecutorKind::cuda && !cuda)
    throw MachineError("the executor cuda cannot be used: " + why);
  return cuda ? ExecutorKind::cuda : ExecutorKind::cpu;
}

RunOptions on_one_thread(RunOptions options, ExecutorKind executor) {
  options.executor = executor;
  options.cpu_threads = 1;
  return options;
}

/// To the end, or to Ctrl-C; seconds that it took.
double run_all(std::vector<Trial>& trials, int jobs, const char* what, const Interruption& interruption) {
  const auto start = std::chrono::steady_clock::now();
  Progress progress(what, std::ssize(trials));
  if (jobs == 0) jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  run_trials(trials, jobs, [&](std::int64_t done) {
    progress.update(done);
    return !interruption.wished();
  });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Writes the file, where one was asked for, and what belongs on stdout.
void report(const Options& options, const std::string& json, const std::string& text) {
  if (!options.json.empty() && options.json != "-") {
    OutputFile file("--json", options.json);
    file.write(json);
    file.commit();
  }
  print(options.json == "-" ? json : text);
  flush_stdout();
}

void save_failures(const StabilityRun& run, const RunOptions& options, const std::string& folder) {
  for (const TrialRow& row : run.rows) {
    if (row.result.verdict != Verdict::failed || !row.result.failed_term) continue;
    std::string bytes;
    write_snapshot(state_in_trial(*row.one, row.setting, options, row.result.last_good),
                   [&](std::string_view more) { bytes += more; });
    const std::string name =
        fmt::format("{}-{}-{}.snapshot", row.one->name, name_of(solver_names, row.setting.solver),
                    name_of(precision_names, row.setting.precision));
    const std::string file = (std::filesystem::path(folder) / name).string();
    write_file_atomically(file, bytes);
    std::fputs(fmt::format("{}: state {}; run --load {} --steps {} comes to what failed\n",
                           name_of(*row.one, row.setting), row.result.last_good, file,
                           row.result.steps - row.result.last_good)
                   .c_str(),
               stderr);
  }
}

int run_suite(const CommandLine& line, const std::vector<HardCase>& cases, const RunOptions& options) {
  const StabilityOptions& asked = line.options.stability;
  const Overrides& chosen = line.options.overrides;
  std::vector<Trial> trials;
  std::vector<const HardCase*> of;
  for (const HardCase& one : cases)
    for (const TrialSetting& setting : trials_of(one, options.executor)) {
      const bool every = !one.criterion.refused.empty();  // of whatever solver
      if (!every && (chosen.solver.value_or(setting.solver) != setting.solver ||
                     chosen.precision.value_or(setting.precision) != setting.precision))
        continue;
      trials.emplace_back(one, setting, options, asked.extended);
      of.push_back(&one);
    }
  StabilityRun run{World(Scene{}, options).info().device_name,
                   options.executor,
                   asked.extended,
                   0,
                   std::ssize(trials),
                   {}};
  const Interruption interruption;
  run.seconds = run_all(trials, asked.jobs, "trials", interruption);
  for (std::size_t k = 0; k < trials.size(); ++k)
    if (trials[k].done()) run.rows.push_back({of[k], trials[k].setting(), trials[k].result()});
  std::exception_ptr not_saved;  // the results are reported all the same
  try {
    if (!asked.save_failures.empty()) save_failures(run, options, asked.save_failures);
  } catch (const MachineError&) {
    not_saved = std::current_exception();
  }
  report(line.options, stability_json(run), stability_text(run));
  if (not_saved) std::rethrow_exception(not_saved);
  if (interruption.wished()) Interruption::obey();
  return run.count(Verdict::failed) == 0 ? 0 : 1;
}

int plant(const CommandLine& line, const std::vector<HardCase>& cases, const RunOptions& options) {
  std::vector<Trial> trials;
  std::vector<PlantedRow> rows;
  for (const HardCase& one : cases)
    for (std::size_t k = 0; k < one.criterion.faults.size(); ++k) {
      const CriterionFault& fault = one.criterion.faults[k];
      trials.emplace_back(one, setting_of(one, fault, options.executor), options,
                          line.options.stability.extended, &fault);
      rows.push_back({&one, k, false, {}});
    }
  const Interruption interruption;
  run_all(trials, line.options.stability.jobs, "faults", interruption);
  std::vector<PlantedRow> known;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (!trials[k].done() || trials[k].result().verdict == Verdict::not_applicable) continue;
    rows[k].shows = trials[k].fault_shows();
    rows[k].result = trials[k].result();
    known.push_back(rows[k]);
  }
  report(line.options, planted_json(known), planted_text(known));
  if (interruption.wished()) Interruption::obey();
  return std::ranges::all_of(known, &PlantedRow::shows) ? 0 : 1;
}

}  // namespace

int stability_command(const CommandLine& line) {
  const StabilityOptions& asked = line.options.stability;
  check_flags(line.options, line.operands);
  if (!asked.readme.empty()) {
    rewrite_readme(asked.readme, asked.from);
    return 0;
  }
  const RunOptions options = on_one_thread(line.options.run, executor_of(line.options.run));
  const std::string folder = asked.cases.empty() ? asset("scenes/hard").string() : asked.cases;
  const std::vector<HardCase> cases = read_hard_cases(folder, line.operands);
  if (!line.options.json.empty() && line.options.json != "-") OutputFile("--json", line.options.json);
  if (!asked.save_failures.empty()) ensure_writable_folder("--save-failures", asked.save_failures);
  return asked.plant ? plant(line, cases, options) : run_suite(line, cases, options);
}

}  // namespace collidoscope
