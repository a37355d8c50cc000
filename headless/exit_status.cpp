#include "headless/exit_status.h"

#include <unistd.h>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "headless/standard_output.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/core/whole_file.h"

namespace collidoscope {
namespace {

void print_faults(const std::vector<std::string>& faults) {
  constexpr std::size_t most = 20;  // a broken file has thousands
  for (std::size_t i = 0; i < faults.size() && i < most; ++i) std::fprintf(stderr, "%s\n", faults[i].c_str());
  if (faults.size() > most) std::fprintf(stderr, "and %zu more\n", faults.size() - most);
}

void tell_of_memory(const char* doing) {
  std::fprintf(stderr,
               "out of memory%s%s: the machine refused an allocation; fewer bodies (--bodies) need less\n",
               *doing != 0 ? " while " : "", doing);
}

}  // namespace

void end_with_a_line_where_memory_ends() {
  static const std::terminate_handler usual = std::get_terminate();
  std::set_terminate([] {
    remove_temporary_files();
    try {
      if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
    } catch (const OutOfMemory& error) {
      tell_of_memory(error.what());
      _exit(machine_lacks);
    } catch (const std::bad_alloc&) {
      tell_of_memory("");
      _exit(machine_lacks);
    } catch (...) {
    }
    usual();
  });
}

int exit_status_of(const std::function<int()>& work) noexcept {
  try {
    const int status = work();
    flush_stdout();
    return status;
  } catch (const InputError& error) {
    print_faults(error.lines());
    return bad_input;
  } catch (const OutOfMemory& error) {
    tell_of_memory(error.what());
  } catch (const std::bad_alloc&) {
    tell_of_memory("");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return machine_lacks;
}

}  // namespace collidoscope
