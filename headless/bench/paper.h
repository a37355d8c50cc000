#pragma once
// The suite `bench paper`: repeats the term project's Tables 1 to 5 with the same (N, B, T) and box, next to
// the paper's figures, and checks the paper's claims.
// The paper's collision handling corresponds to the whole step except the forwarding. Here it includes
// colouring and walls, unlike the paper's.
// The default sort is the paper's (radix_sort.h); --sort changes it. Tables 3 to 5 are measured with the
// paper's queries and with this project's queries (PaperQuery).

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError. The files contain the results measured before.
int bench_paper(const CommandLine& line);

}  // namespace collidoscope
