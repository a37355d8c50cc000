#include "headless/cli/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

[[noreturn]] void fail() {
  throw MachineError(std::string("stdout: writing failed: ") +
                     (errno != 0 ? std::strerror(errno) : "an earlier write failed"));
}

}  // namespace

void print(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail();
}

void flush_stdout() {
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fail();
}

}  // namespace collidoscope
