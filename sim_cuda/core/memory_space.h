#pragma once
// Memory of one executor: allocations, bytes in use, limits, and dry runs, which compute the bytes that an
// operation would need. Sizes in bytes.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <unordered_map>

#include "sim_cuda/core/compute_device.h"
#include "sim_cuda/core/executor_options.h"

namespace collidoscope {

class MemorySpace {
 public:
  /// Manages memory of `device`, which must outlive this object. Uses the options memory_limit and
  /// allow_large.
  MemorySpace(const ComputeDevice& device, const ExecutorOptions& options);
  MemorySpace(const MemorySpace&) = delete;
  MemorySpace& operator=(const MemorySpace&) = delete;

  /// Throws MachineError if there is too little memory. `name` (a literal) appears in that message and in
  /// bytes_by_name(). Host memory is 64-byte aligned. Returns null for 0 bytes.
  void* allocate(const char* name, std::size_t bytes);
  /// `bytes` as passed to allocate(). `memory` may be null.
  void release(void* memory, std::size_t bytes);
  std::int64_t allocated_bytes() const { return allocated_bytes_; }
  /// Allocated bytes per name.
  std::map<std::string, std::int64_t> bytes_by_name() const;

  /// Bytes that are free on the machine, limited by the rest of ExecutorOptions::memory_limit.
  std::int64_t available_bytes() const;
  /// Bytes available for more buffers. Equals available_bytes() with ExecutorOptions::memory_limit or
  /// allow_large. Otherwise it is the rest of 80 % of the memory that this executor has or could get.
  std::int64_t room_bytes() const;

  /// Returns the change of allocated_bytes() that `reserve` would cause. During the call, buffers keep their
  /// size and contents, and fills have no effect.
  std::int64_t dry_run_allocation(const std::function<void()>& reserve);
  /// As dry_run_allocation(), but `make` also creates and destroys buffers. They have a size but no memory,
  /// so `make` must not run stages.
  std::int64_t dry_run_construction(const std::function<void()>& make);
  bool is_construction_dry_run() const { return is_construction_dry_run_; }
  bool is_dry_run() const { return is_dry_run_; }
  /// Records that a buffer would grow by `bytes` (negative: shrink).
  void count_dry_run_bytes(std::int64_t bytes) { dry_run_bytes_ += bytes; }

 private:
  const ComputeDevice& device_;
  const std::int64_t memory_limit_;  ///< bytes; 0: no limit
  const bool allow_large_;
  std::int64_t allocated_bytes_ = 0;
  struct Allocation {
    const char* name;
    std::size_t bytes;
  };
  std::unordered_map<const void*, Allocation> allocations_;
  bool is_dry_run_ = false, is_construction_dry_run_ = false;
  std::int64_t dry_run_bytes_ = 0;
};

}  // namespace collidoscope
