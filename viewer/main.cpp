// collidoscope: the window. Exit status: 0; 2 for invalid input; 3 for missing hardware, memory or display.

#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include "headless/cli/command_line.h"
#include "headless/cli/exit_status.h"
#include "headless/cli/interrupt_handler.h"
#include "headless/cli/plugins.h"
#include "headless/cli/process.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/cli/tuned_option.h"
#include "sim_cuda/plugin/validation.h"
#include "sim_cuda/stability/hard_case.h"
#include "viewer/app.h"

namespace collidoscope {
namespace {

/// Exits without waiting for the GPU, which may be busy for minutes after a cancellation.
[[noreturn]] void end_at_once() {
  std::fflush(nullptr);
  _exit(done);
}

int show(CommandLine line) {
  if (!line.text.empty()) {
    print(line.text + '\n');
    return done;
  }
  announce_long_work();
  // Ctrl+C closes the window in the normal way, so that the settings are written.
  static Cancellation cancellation;
  const InterruptHandler interrupt_handler(cancellation, false);
  line.options.run.cancellation = &cancellation;
  try {
    load_plugins(line.options);
    const Start start = load_start(line);
    load_tuned(line.options);
    // Reports an invalid folder at once, not when the panel opens.
    if (const std::string& cases = line.options.stability.cases; !cases.empty()) read_hard_cases(cases);
    App app(start, line.options);
    if (app.run([&] { return interrupt_handler.requested(); })) end_at_once();
  } catch (const Cancelled&) {  // cancelled before the first frame
    end_at_once();
  }
  return done;
}

}  // namespace
}  // namespace collidoscope

int main(int argc, char** argv) {
  collidoscope::prepare_process();
  collidoscope::install_out_of_memory_handler();
  return collidoscope::run_and_report_errors([&] {
    const std::vector<std::string> arguments(argv + (argc > 0 ? 1 : 0), argv + argc);
    if (const auto status = collidoscope::run_validation_child(arguments)) return *status;
    return collidoscope::show(collidoscope::parse_viewer_line(arguments));
  });
}
