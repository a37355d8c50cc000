#pragma once
// Ranges of some values over a whole run, for a picture of fixed width. A run of any length takes constant
// memory. Plain data on the host.

#include <array>
#include <cstdint>
#include <vector>

namespace collidoscope {

class RunLanes {
 public:
  enum Lane { energy, contacts, step_ms };
  static constexpr std::size_t lanes = 3;
  /// Smallest and largest value; NaN: none.
  struct Range {
    float low, high;
  };
  using Ranges = std::array<Range, lanes>;

  /// Begins at a state. Forgets everything before.
  void begin(std::int64_t first);
  /// Values of a state, later than all before; NaN: not measured.
  void add(std::int64_t state, const std::array<float, lanes>& values);
  /// Forgets the states after `state`.
  void forget_after(std::int64_t state);

  /// Item k is of the states first() + k * states_per_item() on.
  const std::vector<Ranges>& items() const { return items_; }
  std::int64_t first() const { return first_; }
  std::int64_t states_per_item() const { return per_item_; }
  /// Of a lane over all items; NaN: none.
  Range total(Lane lane) const;

 private:
  static constexpr std::size_t most_items = 1024;

  std::vector<Ranges> items_;
  std::int64_t first_ = 0, per_item_ = 1;
};

}  // namespace collidoscope
