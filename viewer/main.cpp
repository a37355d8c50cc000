// collidoscope: the window. The exit status is 0, 2 for bad input, 3 where the machine lacks something.

#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include "headless/cli/command_line.h"
#include "headless/cli/exit_status.h"
#include "headless/cli/interrupt_handler.h"
#include "headless/cli/process.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "sim_cuda/stability/hard_case.h"
#include "viewer/app.h"

namespace collidoscope {
namespace {

/// After a cancellation: a GPU may still be at work, and waiting for it may take minutes.
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
  // Ctrl+C closes the window as its button does: the settings are written.
  static Cancellation cancellation;
  const InterruptHandler interrupt_handler(cancellation, false);
  line.options.run.cancellation = &cancellation;
  try {
    const Start start = load_start(line);
    // A wrong folder is reported now, not when the panel opens.
    if (const std::string& cases = line.options.stability.cases; !cases.empty()) read_hard_cases(cases);
    App app(start, line.options);
    if (app.run([&] { return interrupt_handler.requested(); })) end_at_once();
  } catch (const Cancelled&) {  // before the first frame
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
    return collidoscope::show(collidoscope::parse_viewer_line({argv + (argc > 0 ? 1 : 0), argv + argc}));
  });
}
