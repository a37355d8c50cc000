#pragma once
// A copy of the state of a run in the memory of its executor. Returning to it copies arrays on the device, so
// it takes less time than a step; RunState goes through the host. Owned by a Simulation.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/run/pipeline.h"

namespace collidoscope {

class StateMark {
 public:
  explicit StateMark(Executor& executor) : executor_(executor), copy_(executor, "marked state") {}

  /// Copies the persistent arrays. Throws MachineError without enough memory.
  void set(Pipeline& pipeline);
  /// Copies them back. Their capacities may have grown since. Returns false and changes nothing if nothing is
  /// marked or the arrays are others.
  bool rewind(Pipeline& pipeline);
  void clear() { sizes_.clear(); }

 private:
  Executor& executor_;
  Buffer<std::byte> copy_;
  std::vector<std::size_t> sizes_;  ///< bytes, by array
};

}  // namespace collidoscope
