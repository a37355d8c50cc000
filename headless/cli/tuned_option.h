#pragma once
// Flag --tuned: which results of `tune` the automatic launch shapes are from, and where `tune` keeps its own.

#include "headless/cli/options.h"
#include "headless/cli/output_file.h"
#include "sim_cuda/tuning/launch_tuner.h"

namespace collidoscope {

/// Fills Options::run.tuned_shapes. A fault of a file that the user did not name is one line on stderr.
/// Throws InputError if the named file has a fault.
void load_tuned(Options& options);

/// Keeps what `tuner` found for `world` in the file of --tuned, or without the flag in the user's cache.
/// `named`: a file that was tried before the measurement; null: not tried. Returns a line for the user;
/// empty: there is nothing to keep, or --tuned is off. Throws InputError if the named file has a fault,
/// FileWriteError.
std::string keep_result(const Options& options, OutputFile* named, World& world, const LaunchTuner& tuner);

/// What keep_result() keeps: the faster one of all stages with the chosen shape, and each with its best.
/// Unset: there were too few pairs, or the reference was not *auto*.
std::optional<TunedShapes> tuned_result(const World& world, const LaunchTuner& tuner);

}  // namespace collidoscope
