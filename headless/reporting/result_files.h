#pragma once
// Output files of a suite: --json, --csv and --markdown. Each is replaced atomically after every row, so an
// interrupted run keeps its results. --plot draws a chart of all results at the end.

#include <string>

#include "headless/cli/options.h"
#include "ui/chart.h"

namespace collidoscope {

class ResultFiles {
 public:
  /// Checks that files can be written and charts drawn, before anything is measured. Throws InputError or
  /// MachineError. `options` must outlive the object.
  explicit ResultFiles(const Options& options);
  void write(const std::string& json, const std::string& csv, const std::string& markdown) const;
  /// Draws the chart. No effect without --plot.
  void plot(const Chart& chart) const;

 private:
  const Options& options_;
};

}  // namespace collidoscope
