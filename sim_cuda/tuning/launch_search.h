#pragma once
// Chooses which launch shapes to measure, and how often, in a map over B and T. It knows only the measured
// times. All shapes are compared with one reference.
//
// First each cell gets a few pairs of measurements, from a middle number of threads to few and to many.
// Beyond a much slower cell, others of the same T are left out. Then the faster half gets twice as many
// pairs, again and again. Shapes between the powers of two around the best one follow. Cells that cannot be
// told apart from the best one form a plateau; the one in its centre is chosen, and confirmed with fresh
// pairs.

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/core/ratio_estimate.h"

namespace collidoscope {

struct LaunchCell {
  enum class State {
    waiting,  ///< not measured yet
    measured,
    infeasible,  ///< the device cannot launch it
    left_out,    ///< beyond a much slower cell of the same T
    wrong,       ///< another state hash than the reference
  };
  LaunchShape shape;
  State state = State::waiting;
  std::string reason;              ///< why it is infeasible, left out or wrong
  std::vector<double> ratios, ms;  ///< by pair: time over that of the reference; time of a step
  RatioEstimate estimate() const { return estimate_ratio(ratios); }
};

class LaunchSearch {
 public:
  static constexpr int first_pairs = 2, most_pairs = 32, fresh_pairs = 41;

  /// Values of B and T, each ascending. `thread_unit`: T is a multiple of it. `middle`: number B * T with
  /// which the search begins. `confirmation_pairs`: fresh pairs of the chosen cell. `pairs_at_once`: the
  /// cells of a comparison take turns after so many pairs, so that a disturbance does not meet one cell
  /// alone.
  LaunchSearch(const std::vector<int>& blocks, const std::vector<int>& threads, int thread_unit,
               std::int64_t middle, int confirmation_pairs = fresh_pairs, int pairs_at_once = most_pairs);

  struct Task {
    std::size_t cell;
    int pairs;
  };
  /// What to measure next. Empty: the search has ended.
  std::optional<Task> next();
  /// A pair of a task, ms per step.
  void add(std::size_t cell, double ms, double reference_ms);
  void exclude(std::size_t cell, LaunchCell::State state, const std::string& reason);
  /// Ends the comparisons, because time is short: only the confirmation follows.
  void hurry();

  /// The first grid_size() cells are all pairs of the values of B and T; shapes between them follow.
  const std::vector<LaunchCell>& cells() const { return cells_; }
  std::size_t grid_size() const { return grid_size_; }
  /// Cells that cannot be told apart from the best one, and the one in their centre. Empty without a
  /// measured cell.
  std::vector<std::size_t> plateau() const;
  std::optional<std::size_t> chosen() const;
  /// The chosen cell over the reference, from fresh pairs alone.
  RatioEstimate confirmation() const { return estimate_ratio(fresh_); }
  bool confirming() const { return phase_ == Phase::confirming; }

 private:
  enum class Phase { screening, halving, refining, confirming, ended };
  void queue(const std::vector<std::size_t>& cells, int pairs);
  void begin_next_phase();
  bool is_left_out(std::size_t cell);
  /// In doublings of B * T.
  double from_middle(LaunchShape shape) const;
  std::vector<std::size_t> fastest_first() const;
  std::vector<std::size_t> shapes_around(std::size_t cell);

  std::vector<LaunchCell> cells_;
  std::size_t grid_size_ = 0;
  int thread_unit_, confirmation_pairs_, pairs_at_once_;
  std::int64_t middle_;
  std::vector<int> blocks_;
  Phase phase_ = Phase::screening;
  std::deque<Task> tasks_;
  std::size_t survivors_ = 0;
  int pairs_ = first_pairs;
  std::optional<std::size_t> chosen_;  ///< set before the confirmation
  std::vector<double> fresh_;
};

}  // namespace collidoscope
