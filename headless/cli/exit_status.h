#pragma once
// What main() returns for what its work threw. A free function.

#include <functional>

namespace collidoscope {

enum ExitStatus { done = 0, bad_input = 2, missing_resource = 3 };

/// What `work` returns; or, with lines on stderr, bad_input for an InputError (the first 20 of its lines) and
/// missing_resource for all else. Throws nothing, and needs no memory to say that there is none.
int run_and_report_errors(const std::function<int()>& work) noexcept;

/// Libraries may let no error out of a function that they declared noexcept. From now on the program ends for
/// want of memory there as well with a line and missing_resource, though at once; files that were being
/// written stay as they were.
void install_out_of_memory_handler();

}  // namespace collidoscope
