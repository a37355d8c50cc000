#pragma once
// A RunState in less memory, with the same bits. For each column of a list, for example the x coordinates,
// only words other than zero are stored, and numbers in single precision as 4 bytes.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim_cuda/run/run_state.h"

namespace collidoscope {

class CompactState {
 public:
  explicit CompactState(const RunState& state);
  RunState state() const;
  std::int64_t steps() const { return steps_; }
  std::int64_t bytes() const { return static_cast<std::int64_t>(data_.size()); }

 private:
  std::int64_t steps_;
  std::vector<std::byte> data_;
};

}  // namespace collidoscope
