#pragma once
// The files of a suite: --json, --csv and --markdown. Each is replaced as a whole after every row, so that a
// run that is cut short keeps what it has. And --plot, a picture of them all at the end.

#include <string>

#include "headless/cli/options.h"
#include "ui/chart.h"

namespace collidoscope {

class ResultFiles {
 public:
  /// Refuses what cannot be written, or drawn, before anything is measured. Throws InputError or
  /// MachineError. `options` outlives it.
  explicit ResultFiles(const Options& options);
  void write(const std::string& json, const std::string& csv, const std::string& markdown) const;
  /// Does nothing where no picture was asked for.
  void plot(const Chart& chart) const;

 private:
  const Options& options_;
};

}  // namespace collidoscope
