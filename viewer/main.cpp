// collidoscope: the window. The exit status is 0, 2 for bad input, 3 where the machine lacks something.

#include <unistd.h>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "headless/command_line.h"
#include "headless/interruption.h"
#include "headless/progress.h"
#include "sim_cuda/core/error.h"
#include "viewer/app.h"

namespace collidoscope {
namespace {

/// After something was cancelled: a GPU may still be at work, and waiting for it may take minutes.
[[noreturn]] void end_at_once() {
  std::fflush(nullptr);
  _exit(0);
}

int guarded_main(const std::vector<std::string>& arguments) {
  try {
    CommandLine line = parse_viewer_line(arguments);
    if (!line.text.empty()) {
      std::puts(line.text.c_str());
      return 0;
    }
    announce_long_work();
    // Ctrl+C closes the window as its button does: what is remembered is written.
    static Cancellation cancellation;
    const Interruption interruption(cancellation, false);
    line.options.run.cancellation = &cancellation;
    App app(load_start(line), line.options);
    const bool cancelled = app.run([&] { return interruption.wished(); });
    if (cancelled) end_at_once();
    return 0;
  } catch (const Cancelled&) {  // before the first frame
    end_at_once();
  } catch (const InputError& error) {
    constexpr std::size_t most = 20;
    const std::vector<std::string>& faults = error.lines();
    for (std::size_t i = 0; i < faults.size() && i < most; ++i)
      std::fprintf(stderr, "%s\n", faults[i].c_str());
    if (faults.size() > most) std::fprintf(stderr, "and %zu more\n", faults.size() - most);
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 3;
}

}  // namespace
}  // namespace collidoscope

int main(int argc, char** argv) {
  return collidoscope::guarded_main(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
}
