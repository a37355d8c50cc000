#pragma once
// A refused allocation that says what was being done. Nothing here takes memory itself.

#include <new>

namespace collidoscope {

class OutOfMemory : public std::bad_alloc {
 public:
  /// A literal that goes on from "out of memory while": "reading a scene".
  explicit OutOfMemory(const char* doing) noexcept : doing_(doing) {}
  const char* what() const noexcept override { return doing_; }

 private:
  const char* doing_;
};

/// Does it. Where memory is refused, the innermost of these says in what.
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
