// collidoscope-headless: the program without a window. Results go to stdout, messages to stderr. Exit status:
// 0 success, 1 failed check, 2 bad input, 3 missing hardware, memory or display.

#include <string>
#include <vector>

#include "headless/accuracy/accuracy.h"
#include "headless/bench/suites.h"
#include "headless/bvh.h"
#include "headless/cli/command_line.h"
#include "headless/cli/exit_status.h"
#include "headless/cli/interrupt_handler.h"
#include "headless/cli/plugins.h"
#include "headless/cli/process.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/cli/tuned_option.h"
#include "headless/compare.h"
#include "headless/markdown/reference_pages.h"
#include "headless/replay.h"
#include "headless/run.h"
#include "headless/stability/stability.h"
#include "headless/tune.h"
#include "headless/validate.h"
#include "sim_cuda/plugin/validation.h"

namespace collidoscope {
namespace {

template <class Run>
int interruptible(CommandLine line, Run command) {
  return run_interruptible([&](Cancellation& cancellation) {
    line.options.run.cancellation = &cancellation;
    if (line.command == Command::run || line.command == Command::capture) load_tuned(line.options);
    return command(line);
  });
}

int perform(CommandLine line) {
  if (!line.text.empty()) {
    print(line.text + '\n');
    return done;
  }
  load_plugins(line.options);
  switch (line.command) {
    case Command::run:
      return interruptible(line, run_command);
    case Command::replay:
      return interruptible(line, replay_command);
    case Command::capture:
      return interruptible(line, capture_command);
    case Command::compare:
      return run_compare(line.operands[0], line.operands[1], line.options.json == "-");
    case Command::bvh:
      return bvh_command(line);
    case Command::bench:
      return bench_command(line);
    case Command::accuracy:
      return accuracy_command(line);
    case Command::stability:
      return stability_command(line);
    case Command::tune:
      return interruptible(line, tune_command);
    case Command::validate:
      return interruptible(line, validate_command);
    case Command::view:
      break;  // not reachable from the command line
  }
  return bad_input;
}

}  // namespace
}  // namespace collidoscope

int main(int argc, char** argv) {
  collidoscope::prepare_process();
  collidoscope::install_out_of_memory_handler();
  return collidoscope::run_and_report_errors([&] {
    const std::vector<std::string> arguments(argv + (argc > 0 ? 1 : 0), argv + argc);
    if (const auto status = collidoscope::run_validation_child(arguments)) return *status;
    if (const auto table = collidoscope::markdown_help(arguments)) {
      collidoscope::print(*table);
      return int{collidoscope::done};
    }
    collidoscope::announce_long_work();
    return collidoscope::perform(collidoscope::parse_command_line(arguments, collidoscope::suites()));
  });
}
