#pragma once
// Buffer<T>: an array in an executor's memory space. Owns its memory. Data moves between host and device only
// by upload() and download(). Contents are undefined after a resize, except after resize_keeping().

#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

template <class T>
class Buffer {
 public:
  static_assert(std::is_trivially_destructible_v<T>);

  /// `name` (a literal) appears in messages about memory. The executor must outlive the buffer.
  Buffer(Executor& executor, const char* name) : executor_(&executor), name_(name) {}
  ~Buffer() { executor_->release(data_, bytes()); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return size_ * sizeof(T); }
  std::span<T> span() const { return {data_, size_}; }

  /// Reallocates to exactly `size` elements with undefined values. No effect if the size is the same.
  void resize_discarding(std::size_t size) {
    if (size == size_) return;
    if (executor_->is_dry_run()) {
      executor_->count_dry_run_bytes(static_cast<std::int64_t>(size * sizeof(T)) -
                                     static_cast<std::int64_t>(bytes()));
      if (executor_->is_construction_dry_run()) size_ = size;
      return;
    }
    executor_->release(data_, bytes());
    data_ = nullptr;
    size_ = 0;
    data_ = static_cast<T*>(executor_->allocate(name_, size * sizeof(T)));
    size_ = size;
  }
  /// Reallocates and keeps the elements that fit, by a copy through the host. If the allocation fails, size
  /// and contents stay unchanged, and the exception is rethrown.
  void resize_keeping(std::size_t size) {
    if (size == size_ || executor_->is_dry_run()) return resize_discarding(size);
    const std::vector<T> kept = download(size < size_ ? size : size_);
    const auto restore = [&] {
      if (!kept.empty()) executor_->copy_to_executor(data_, kept.data(), kept.size() * sizeof(T));
    };
    try {
      resize_discarding(size);
    } catch (...) {
      resize_discarding(kept.size());
      restore();
      throw;
    }
    restore();
  }
  void upload(const std::vector<T>& host) {
    resize_discarding(host.size());
    executor_->copy_to_executor(data_, host.data(), bytes());
  }
  std::vector<T> download() const { return download(size_); }
  std::vector<T> download(std::size_t count) const {
    std::vector<T> host(count);
    executor_->copy_to_host(host.data(), data_, count * sizeof(T));
    return host;
  }
  void fill_zero() const { executor_->fill(data_, 0, bytes()); }

 private:
  Executor* executor_;
  const char* name_;
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace collidoscope
