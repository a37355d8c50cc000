#pragma once
// A buffer object that only grows. Owns its storage; what it held is lost when it grows, and its name changes
// then (whoever registered it with CUDA asks generation()).

#include <cstddef>
#include <string>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class Buffer {
 public:
  explicit Buffer(std::string name) : name_(std::move(name)) {}

  /// Room for at least `bytes` (never less than 16, so that there is always something to bind).
  void reserve(std::size_t bytes);
  /// reserve(), then copies to the start.
  void upload(const void* data, std::size_t bytes);
  void read(void* data, std::size_t bytes) const;

  GLuint get() const { return handle_.get(); }
  std::size_t capacity() const { return capacity_; }  ///< bytes
  int generation() const { return generation_; }      ///< how often the storage was made anew

 private:
  std::string name_;
  BufferHandle handle_;
  std::size_t capacity_ = 0;
  int generation_ = 0;
};

}  // namespace collidoscope::gl
