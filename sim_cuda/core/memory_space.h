#pragma once
// The memory of one executor: allocation, the sum of bytes in use, limits, and dry runs that find out how
// many bytes an operation would need.

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
  /// Memory of `device`, which must outlive this object. Of the options, memory_limit and allow_large.
  MemorySpace(const ComputeDevice& device, const ExecutorOptions& options);
  MemorySpace(const MemorySpace&) = delete;
  MemorySpace& operator=(const MemorySpace&) = delete;

  /// Host memory is 64-byte aligned. `name` (a literal) appears in bytes_by_name() and in the MachineError
  /// that is thrown if there is too little memory. 0 bytes: returns null.
  void* allocate(const char* name, std::size_t bytes);
  /// `bytes` as given to allocate(). `memory` may be null.
  void release(void* memory, std::size_t bytes);
  std::int64_t allocated_bytes() const { return allocated_bytes_; }
  /// Allocated bytes. Allocations of the same name are added up.
  std::map<std::string, std::int64_t> bytes_by_name() const;

  /// Bytes that are free on the machine, but no more than ExecutorOptions::memory_limit leaves.
  std::int64_t available_bytes() const;
  /// Bytes that more buffers may occupy. With ExecutorOptions::memory_limit or allow_large:
  /// available_bytes(). Else what is left of 80 % of the memory that this executor has or could have.
  std::int64_t room_bytes() const;

  /// By how many bytes `reserve` would change allocated_bytes(). While it runs, buffers keep their size and
  /// their contents, and fills do nothing.
  std::int64_t dry_run_allocation(const std::function<void()>& reserve);
  /// The same for `make`, which creates buffers and destroys them before it returns. They have a size, but no
  /// memory: `make` must not run stages.
  std::int64_t dry_run_construction(const std::function<void()>& make);
  bool is_construction_dry_run() const { return is_construction_dry_run_; }
  bool is_dry_run() const { return is_dry_run_; }
  /// A buffer would grow by so many bytes (negative: shrink).
  void count_dry_run_bytes(std::int64_t bytes) { dry_run_bytes_ += bytes; }

 private:
  const ComputeDevice& device_;
  const std::int64_t memory_limit_;  ///< bytes; 0: none
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
