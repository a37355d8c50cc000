#pragma once
// What main() returns for what its work threw. A free function.

#include <functional>

namespace collidoscope {

enum ExitStatus { done = 0, bad_input = 2, machine_lacks = 3 };

/// What `work` returns; or, with lines on stderr, bad_input for an InputError (the first 20 of its lines) and
/// machine_lacks for all else. Throws nothing, and needs no memory to say that there is none.
int exit_status_of(const std::function<int()>& work) noexcept;

/// Libraries may let no error out of a function that they declared noexcept. From now on the program ends for
/// want of memory there as well with a line and machine_lacks, though at once; files that were being written
/// stay as they were.
void end_with_a_line_where_memory_ends();

}  // namespace collidoscope
