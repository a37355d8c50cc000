#pragma once
// A backup copy of arrays on the host, to be restored. For what a step on the CPU writes in place.

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "sim_cuda/core/parallel_for.h"

namespace collidoscope {

/// Is given arrays, one by one.
using ArrayVisitor = std::function<void(void* data, std::size_t bytes)>;

class HostBackup {
 public:
  /// Copies what `visit_all` gives to the visit that it is called with; the arrays stay where they are until
  /// restore(). Throws std::bad_alloc.
  void save(ThreadTeam& team, const std::function<void(const ArrayVisitor&)>& visit_all);
  bool has_copy() const { return !arrays_.empty(); }
  void restore(ThreadTeam& team);
  void clear() { arrays_.clear(); }

 private:
  struct Array {
    std::byte* place;
    std::size_t bytes, at;  ///< `at`, in the copy
  };
  std::vector<Array> arrays_;
  std::unique_ptr<std::byte[]> copy_;
  std::size_t capacity_ = 0;  ///< of copy_
};

}  // namespace collidoscope
