#pragma once
// Backup of host arrays, which can be restored. Used for data that a CPU step modifies in place. Owns the
// copy.

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// Called once per array.
using ArrayVisitor = std::function<void(void* data, std::size_t bytes)>;

class HostBackup {
 public:
  /// Copies all arrays that `visit_all` passes to its visitor. The arrays must not move until restore().
  /// Throws std::bad_alloc.
  void save(Executor& executor, const std::function<void(const ArrayVisitor&)>& visit_all);
  bool has_copy() const { return !arrays_.empty(); }
  void restore(Executor& executor);
  void clear() { arrays_.clear(); }

 private:
  struct Array {
    std::byte* place;
    std::size_t bytes, at;  ///< `at`: offset in the copy, bytes
  };
  std::vector<Array> arrays_;
  std::unique_ptr<std::byte[]> copy_;
  std::size_t capacity_ = 0;  ///< bytes of copy_
};

}  // namespace collidoscope
