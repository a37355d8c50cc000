#include "headless/cli/exit_status.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "headless/cli/standard_output.h"
#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"

namespace collidoscope {
namespace {

/// Without its control characters, which a file's name may hold. Takes no memory.
void print_line(std::string_view line) {
  char block[1024];
  while (!line.empty()) {
    const std::size_t size = std::min(line.size(), sizeof block);
    for (std::size_t k = 0; k < size; ++k)
      block[k] = static_cast<unsigned char>(line[k]) < 0x20 || line[k] == 0x7f ? '?' : line[k];
    std::fwrite(block, 1, size, stderr);
    line.remove_prefix(size);
  }
  std::fputc('\n', stderr);
}

void print_faults(const std::vector<std::string>& faults) {
  constexpr std::size_t most = 20;  // a broken file has thousands
  for (std::size_t i = 0; i < faults.size() && i < most; ++i) print_line(faults[i]);
  if (faults.size() > most) std::fprintf(stderr, "and %zu more errors\n", faults.size() - most);
}

void report_out_of_memory(const char* activity) {
  std::fprintf(stderr, "out of memory%s%s; use fewer bodies (--bodies)\n", *activity != 0 ? " while " : "",
               activity);
}

}  // namespace

void install_out_of_memory_handler() {
  static const std::terminate_handler usual = std::get_terminate();
  std::set_terminate([] {
    remove_temporary_files();
    try {
      if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
    } catch (const OutOfMemory& error) {
      report_out_of_memory(error.what());
      _exit(missing_resource);
    } catch (const std::bad_alloc&) {
      report_out_of_memory("");
      _exit(missing_resource);
    } catch (...) {
    }
    usual();
  });
}

int run_and_report_errors(const std::function<int()>& work) noexcept {
  try {
    const int status = work();
    flush_stdout();
    return status;
  } catch (const InputError& error) {
    print_faults(error.lines());
    return bad_input;
  } catch (const OutOfMemory& error) {
    report_out_of_memory(error.what());
  } catch (const std::bad_alloc&) {
    report_out_of_memory("");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return missing_resource;
}

}  // namespace collidoscope
