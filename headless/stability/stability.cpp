#include "headless/stability/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <thread>

#include "headless/cli/interrupt_handler.h"
#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/stability/stability_readme.h"
#include "headless/stability/stability_report.h"
#include "headless/stability/test_pool.h"
#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

/// Rejects contradictory flags.
void check_flags(const Options& options, const std::vector<std::string>& cases) {
  std::vector<std::string> faults;
  const StabilityOptions& stability = options.stability;
  const SettingsPatch& chosen = options.overrides.settings;
  if (stability.write_table.empty() != stability.from.empty())
    faults.emplace_back(stability.from.empty()
                            ? "--write-table: missing --from FILE, a report of stability --json"
                            : "--from: needs --write-table FILE");
  if (!stability.write_table.empty() && (!cases.empty() || stability.inject_faults || !options.json.empty()))
    faults.emplace_back("--write-table: runs no trials; remove CASE, --inject-faults and --json");
  if (stability.inject_faults && (chosen.has<&Physics::solver>() || chosen.has<&Physics::precision>() ||
                                  !stability.save_failures.empty()))
    faults.emplace_back(
        "--inject-faults: uses solver and precision of the scenes; remove --solver, --precision and "
        "--save-failures");
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

/// Runs all tests to the end or to Ctrl-C. Returns the wall-clock seconds.
double run_all(std::vector<TestRun>& test_runs, int jobs, const char* what,
               const InterruptHandler& interrupt_handler) {
  const auto start = std::chrono::steady_clock::now();
  Progress progress(what, std::ssize(test_runs));
  if (jobs == 0) jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  run_tests(test_runs, jobs, [&](std::int64_t done) {
    progress.update(done);
    return !interrupt_handler.requested();
  });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Writes the --json file, if requested, and prints the text or the JSON on stdout.
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
  for (const TestRow& row : run.rows) {
    if (row.result.outcome != TestOutcome::failed || !row.result.failed_assertion) continue;
    std::string bytes;
    write_snapshot(replay_to_state(*row.hard_case, row.configuration, options, row.result.last_passing_state),
                   [&](std::string_view more) { bytes += more; });
    const std::string name =
        fmt::format("{}-{}-{}.snapshot", row.hard_case->name, name_of(solver_names, row.configuration.solver),
                    name_of(precision_names, row.configuration.precision));
    const std::string file = (std::filesystem::path(folder) / name).string();
    write_file_atomically(file, bytes);
    std::fputs(
        fmt::format("{}: state {}; reproduce the failure with run --load {} --steps {}\n",
                    name_of(*row.hard_case, row.configuration), row.result.last_passing_state, file,
                    row.result.assertions[*row.result.failed_assertion].state - row.result.last_passing_state)
            .c_str(),
        stderr);
  }
}

int run_suite(const CommandLine& line, const std::vector<HardCase>& cases, const RunOptions& options) {
  const StabilityOptions& asked = line.options.stability;
  const SettingsPatch& chosen = line.options.overrides.settings;
  std::vector<TestRun> test_runs;
  std::vector<const HardCase*> of;
  for (const HardCase& hard_case : cases)
    for (const TestConfiguration& configuration : test_configurations(hard_case, options.executor)) {
      const bool every = !hard_case.criterion.refused.empty();  // rejected scene: applies to every solver
      if (!every &&
          (chosen.get<&Physics::solver>().value_or(configuration.solver) != configuration.solver ||
           chosen.get<&Physics::precision>().value_or(configuration.precision) != configuration.precision))
        continue;
      test_runs.emplace_back(hard_case, configuration, options, asked.extended);
      of.push_back(&hard_case);
    }
  StabilityRun run{World(Scene{}, options).info().device_name,
                   options.executor,
                   asked.extended,
                   0,
                   std::ssize(test_runs),
                   {}};
  const InterruptHandler interrupt_handler;
  run.seconds = run_all(test_runs, asked.jobs, "trials", interrupt_handler);
  for (std::size_t k = 0; k < test_runs.size(); ++k)
    if (test_runs[k].done()) run.rows.push_back({of[k], test_runs[k].configuration(), test_runs[k].result()});
  std::exception_ptr not_saved;  // the results are reported in any case
  try {
    if (!asked.save_failures.empty()) save_failures(run, options, asked.save_failures);
  } catch (const MachineError&) {
    not_saved = std::current_exception();
  }
  report(line.options, stability_json(run), stability_text(run));
  if (not_saved) std::rethrow_exception(not_saved);
  if (interrupt_handler.requested()) InterruptHandler::reraise();
  return run.count(TestOutcome::failed) == 0 ? 0 : 1;
}

int run_injected_faults(const CommandLine& line, const std::vector<HardCase>& cases,
                        const RunOptions& options) {
  std::vector<TestRun> test_runs;
  std::vector<InjectedFaultRow> rows;
  for (const HardCase& hard_case : cases)
    for (std::size_t k = 0; k < hard_case.criterion.injected_faults.size(); ++k) {
      const InjectedFault& fault = hard_case.criterion.injected_faults[k];
      test_runs.emplace_back(hard_case, configuration_of(hard_case, fault, options.executor), options,
                             line.options.stability.extended, &fault);
      rows.push_back({&hard_case, k, false, {}});
    }
  const InterruptHandler interrupt_handler;
  run_all(test_runs, line.options.stability.jobs, "faults", interrupt_handler);
  std::vector<InjectedFaultRow> known;
  for (std::size_t k = 0; k < test_runs.size(); ++k) {
    if (!test_runs[k].done() || test_runs[k].result().outcome == TestOutcome::not_applicable) continue;
    rows[k].shows = test_runs[k].fault_detected();
    rows[k].result = test_runs[k].result();
    known.push_back(rows[k]);
  }
  report(line.options, injected_faults_json(known), injected_faults_text(known));
  if (interrupt_handler.requested()) InterruptHandler::reraise();
  return std::ranges::all_of(known, &InjectedFaultRow::shows) ? 0 : 1;
}

}  // namespace

int stability_command(const CommandLine& line) {
  const StabilityOptions& asked = line.options.stability;
  check_flags(line.options, line.operands);
  if (!asked.write_table.empty()) {
    rewrite_readme(asked.write_table, asked.from);
    return 0;
  }
  const RunOptions options = on_one_thread(line.options.run, executor_of(line.options.run));
  const std::string folder = asked.cases.empty() ? asset("scenes/hard").string() : asked.cases;
  const std::vector<HardCase> cases = read_hard_cases(folder, line.operands);
  for (const HardCase& one : cases)
    for (const std::string& warning : one.criterion.warnings) fmt::print(stderr, "{}\n", warning);
  if (!line.options.json.empty() && line.options.json != "-") OutputFile("--json", line.options.json);
  if (!asked.save_failures.empty()) ensure_writable_folder("--save-failures", asked.save_failures);
  return asked.inject_faults ? run_injected_faults(line, cases, options) : run_suite(line, cases, options);
}

}  // namespace collidoscope
