#pragma once
// The files of a suite: --json, --csv and --markdown. Each is replaced as a whole after every row, so that a
// run that is cut short keeps what it has.

#include <string>

#include "headless/options.h"

namespace collidoscope {

class ResultFiles {
 public:
  /// Refuses what cannot be written, before anything is measured. Throws InputError. `options` outlives it.
  explicit ResultFiles(const Options& options);
  void write(const std::string& json, const std::string& csv, const std::string& markdown) const;

 private:
  const Options& options_;
};

}  // namespace collidoscope
