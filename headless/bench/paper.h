#pragma once
// `bench paper`: the term project's Tables 1 to 5 again, with the same (N, B, T) in the same box, its figures
// beside ours, and its claims put to the test. What it calls collision handling is all of our step but
// the forwarding, so that ours has colouring and walls in it, which its has not. The sort is the paper's too
// (radix_sort.h), unless --sort says otherwise. Tables 3 to 5 are measured twice: with the queries that the
// paper describes, and with ours (PaperQuery).

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError; what was measured before is in the files.
int bench_paper(const CommandLine& line);

}  // namespace collidoscope
