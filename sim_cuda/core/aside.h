#pragma once
// A copy of arrays on the host, put aside to be put back. For what a step on the CPU writes in place.

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "sim_cuda/core/parallel_for.h"

namespace collidoscope {

/// Is given arrays, one by one.
using ArrayVisit = std::function<void(void* data, std::size_t bytes)>;

class Aside {
 public:
  /// Copies what `visit_all` gives to the visit that it is called with; the arrays stay where they are until
  /// put_back(). Throws std::bad_alloc.
  void put(ThreadTeam& team, const std::function<void(const ArrayVisit&)>& visit_all);
  bool holds() const { return !arrays_.empty(); }
  void put_back(ThreadTeam& team);
  void forget() { arrays_.clear(); }

 private:
  struct Array {
    std::byte* place;
    std::size_t bytes, at;  ///< `at`, in the copy
  };
  std::vector<Array> arrays_;
  std::unique_ptr<std::byte[]> copy_;
  std::size_t room_ = 0;  ///< of copy_
};

}  // namespace collidoscope
