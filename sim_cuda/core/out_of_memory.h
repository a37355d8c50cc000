#pragma once
// Out-of-memory errors with a description of the current operation. This code allocates no memory.

#include <new>

namespace collidoscope {

class OutOfMemory : public std::bad_alloc {
 public:
  /// `doing`: a literal that continues "out of memory while", such as "reading a scene".
  explicit OutOfMemory(const char* doing) noexcept : doing_(doing) {}
  const char* what() const noexcept override { return doing_; }

 private:
  const char* doing_;
};

/// Calls `work`. Converts std::bad_alloc to OutOfMemory(doing). With nested calls the innermost description
/// is kept.
template <class Work>
decltype(auto) with_allocation_context(const char* doing, const Work& work) {
  try {
    return work();
  } catch (const OutOfMemory&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(doing);
  }
}

}  // namespace collidoscope
