#pragma once
// `bench predictors`: which measure of a tree's quality predicts how long its queries take. Every method with
// a tree, over variants and N: measured, its queries timed twice (the method's own, and one and the same
// query over all trees), and Spearman's rank correlation of each measure with the time of a query.

#include "headless/cli/command_line.h"

namespace collidoscope {

/// Throws InputError and MachineError; rows that were measured before are in the files.
int bench_predictors(const CommandLine& line);

}  // namespace collidoscope
