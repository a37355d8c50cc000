#pragma once
// The suite `bench predictors`: finds the measure of tree quality that best predicts query times.
// Measures every method with a tree over variants and N. Times two queries: the method's own, and one common
// query over all trees. Reports Spearman's rank correlation of each measure with the query time.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError. The files contain the rows measured before.
int bench_predictors(const CommandLine& line);

}  // namespace collidoscope
