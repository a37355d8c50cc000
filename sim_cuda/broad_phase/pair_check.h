#pragma once
// What is found about the pairs of a plug-in. Plain data.

#include <cstdint>
#include <string>
#include <vector>

namespace collidoscope {

enum class PairFault : std::uint32_t {
  missing,       ///< overlapping boxes that were not listed
  duplicate,     ///< listed more than once
  out_of_range,  ///< no two different boxes
  apart          ///< boxes that do not overlap; such pairs are left out and are no error
};
constexpr std::size_t pair_faults = 4;

struct FaultyPair {
  std::uint32_t a, b;  ///< as listed; `missing`: a < b
  PairFault fault;
};

/// Since the broad phase was created. A "run" is one run of the pipeline.
struct PairCheck {
  bool compares = false;          ///< with lbvh_ropes, in each run; otherwise missing pairs are not noticed
  std::uint64_t runs = 0;         ///< accepted runs
  std::uint64_t wrong_runs = 0;   ///< those with an error
  std::uint64_t first_wrong = 0;  ///< number of the first of them, from 0
  std::uint64_t pairs[pair_faults] = {};  ///< by PairFault, in all runs
  std::uint64_t writes_beyond = 0;        ///< runs with a write behind the capacity of the list
  std::uint64_t absurd_counts = 0;        ///< runs with more pairs than a list can have
  /// Of the last run with an error or a pair apart, at most `most_examples`, sorted.
  std::vector<FaultyPair> examples;
  bool examples_are_of_last_run = false;
  std::vector<std::string> tree_faults;  ///< of the last tree; it is not used then

  static constexpr std::size_t most_examples = 64;
  std::uint64_t of(PairFault fault) const { return pairs[static_cast<std::size_t>(fault)]; }
  bool is_wrong() const { return wrong_runs > 0 || !tree_faults.empty(); }
};

const char* name_of(PairFault fault);
/// A note for every place that shows numbers of a run with a plug-in; the short one has no examples.
std::string note_of(const PairCheck& check);
std::string short_note_of(const PairCheck& check);
/// Such as "12 missing in 3 of 300 runs, such as 4-17, 8-9; 1 duplicate"; empty without an error.
std::string describe(const PairCheck& check);

}  // namespace collidoscope
