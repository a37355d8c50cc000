// collidoscope: the window. The exit status is 0, 2 for bad input, 3 where the machine lacks something.

#include <csignal>
#include <string>
#include <vector>

#include "headless/command_line.h"
#include "headless/exit_status.h"
#include "headless/process.h"
#include "headless/progress.h"
#include "headless/standard_output.h"
#include "sim_cuda/stability/hard_case.h"
#include "viewer/app.h"

namespace collidoscope {
namespace {

volatile std::sig_atomic_t interrupted = 0;

int show(const CommandLine& line) {
  if (!line.text.empty()) {
    print(line.text + '\n');
    return done;
  }
  announce_settling();
  const Start start = load_start(line);
  // A wrong folder is reported now, not when the panel opens.
  if (const std::string& cases = line.options.stability.cases; !cases.empty()) read_hard_cases(cases);
  App(start, line.options).run([] { return interrupted != 0; });
  return done;
}

}  // namespace
}  // namespace collidoscope

int main(int argc, char** argv) {
  collidoscope::prepare_process();
  collidoscope::end_with_a_line_where_memory_ends();
  // Ctrl+C closes the window as its button does: what is remembered is written.
  for (int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { collidoscope::interrupted = 1; });
  return collidoscope::exit_status_of([&] {
    return collidoscope::show(collidoscope::parse_viewer_line({argv + (argc > 0 ? 1 : 0), argv + argc}));
  });
}
