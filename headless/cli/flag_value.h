#pragma once
// One flag's text, read into a value. What is wrong is written to the caller's list of faults, a line each,
// such as `--bodies: -5 is not a whole number from 0 to 134217728`; nothing is thrown, so that one run of the
// program names every fault. Lives for one reading; the text and the list are the caller's.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {

/// The text as it may stand in a line of output: no control characters, not endless; '' if empty.
std::string shown(std::string_view text);

class FlagValue {
 public:
  FlagValue(std::string_view flag, std::string_view text, std::vector<std::string>& faults)
      : flag_(flag), text_(text), faults_(&faults) {}

  std::string_view flag() const { return flag_; }
  std::string_view text() const { return text_; }
  /// Part of the text, as a value of the same flag.
  FlagValue part(std::string_view text) const { return FlagValue(flag_, text, *faults_); }
  /// The parts between the commas.
  std::vector<FlagValue> parts() const;
  /// Adds the line `flag: text is not <right>`.
  void refuse(std::string_view right);
  /// Adds the line `flag: what`.
  void fault(std::string_view what);
  /// Adds lines that begin with the flag.
  void add(std::span<const std::string> lines) {
    faults_->insert(faults_->end(), lines.begin(), lines.end());
  }

  /// A whole number in decimal, min to max inclusive. `or_word`: how the fault names a word that the caller
  /// has taken already, such as " or auto".
  std::optional<std::int64_t> whole(std::int64_t min, std::int64_t max, std::string_view or_word = "");
  std::optional<std::uint64_t> whole_u64();
  /// A finite number in decimal, min to max inclusive.
  std::optional<double> number(double min, double max, std::string_view unit, std::string_view or_word = "");
  /// x,y,z, each finite, |component| <= limit.
  std::optional<Vector3d> vector(double limit, std::string_view unit);
  /// A name from a table of sim_cuda/scene/names.h.
  template <class Choice>
  std::optional<Choice> one_of(std::span<const Named<Choice>> table) {
    const std::optional<Choice> choice = value_of(table, text_);
    if (!choice) unknown(names_in(table));
    return choice;
  }
  /// The text itself if it is one of `words`. `what`: how the fault names another one; empty: as the flag.
  std::optional<std::string> word(std::span<const std::string> words, std::string_view what = "");

 private:
  void unknown(std::span<const std::string_view> names, std::string_view what = "");

  std::string_view flag_, text_;
  std::vector<std::string>* faults_;
};

}  // namespace collidoscope
