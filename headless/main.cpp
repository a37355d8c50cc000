// collidoscope-headless: the program without a window. Results go to stdout, all else to stderr; the exit
// status is 0 where the work was done, 1 where a check failed, 2 for bad input, 3 where the machine lacks
// something.

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "headless/accuracy/accuracy.h"
#include "headless/bench/suites.h"
#include "headless/bvh.h"
#include "headless/command_line.h"
#include "headless/compare.h"
#include "headless/progress.h"
#include "headless/run.h"
#include "headless/stability/stability.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

enum ExitStatus { done = 0, bad_input = 2, machine_lacks = 3 };

int perform(const CommandLine& line) {
  if (!line.text.empty()) {
    std::puts(line.text.c_str());
    return done;
  }
  switch (line.command) {
    case Command::run:
      return run_command(line);
    case Command::capture:
      return capture_command(line);
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
    case Command::view:
      break;  // no word of the command line means it
  }
  return bad_input;
}

void print_faults(const std::vector<std::string>& faults) {
  constexpr std::size_t most = 20;  // a broken file has thousands
  for (std::size_t i = 0; i < faults.size() && i < most; ++i) std::fprintf(stderr, "%s\n", faults[i].c_str());
  if (faults.size() > most) std::fprintf(stderr, "and %zu more\n", faults.size() - most);
}

int guarded_main(const std::vector<std::string>& arguments) {
  try {
    announce_settling();
    const int status = perform(parse_command_line(arguments));
    if (!std::cout.flush() || std::fflush(stdout) != 0)  // a full disk behind a redirection
      throw MachineError(std::string("stdout: writing failed: ") + std::strerror(errno));
    return status;
  } catch (const InputError& error) {
    print_faults(error.lines());
    return bad_input;
  } catch (const std::bad_alloc&) {
    std::fputs("out of memory: the machine refused an allocation; fewer bodies (--bodies) need less\n",
               stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return machine_lacks;
}

}  // namespace
}  // namespace collidoscope

int main(int argc, char** argv) {
  // A reader that left (| head) ends the program without a word, even where a parent ignores the signal.
  std::signal(SIGPIPE, SIG_DFL);
  return collidoscope::guarded_main(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
}
