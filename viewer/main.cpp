// collidoscope: the window. The exit status is 0, 2 for bad input, 3 where the machine lacks something.

#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "headless/command_line.h"
#include "headless/progress.h"
#include "sim_cuda/core/error.h"
#include "viewer/app.h"

namespace collidoscope {
namespace {

volatile std::sig_atomic_t interrupted = 0;

int guarded_main(const std::vector<std::string>& arguments) {
  try {
    const CommandLine line = parse_viewer_line(arguments);
    if (!line.text.empty()) {
      std::puts(line.text.c_str());
      return 0;
    }
    announce_settling();
    App(load_start(line), line.options).run([] { return interrupted != 0; });
    return 0;
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
  // Ctrl+C closes the window as its button does: what is remembered is written.
  for (int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { collidoscope::interrupted = 1; });
  return collidoscope::guarded_main(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
}
