#pragma once
// A growing buffer object. Growing discards the contents and changes the GL name. generation() detects this,
// for example for registrations with CUDA. Owns its storage.

#include <cstddef>
#include <string>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class Buffer {
 public:
  explicit Buffer(std::string name) : name_(std::move(name)) {}

  /// Ensures room for `bytes`, at least 16, so that there is always a buffer to bind.
  void reserve(std::size_t bytes);
  /// Calls reserve() and copies the data to the start.
  void upload(const void* data, std::size_t bytes);
  void read(void* data, std::size_t bytes) const;

  GLuint get() const { return handle_.get(); }
  std::size_t capacity() const { return capacity_; }  ///< bytes
  int generation() const { return generation_; }      ///< number of reallocations

 private:
  std::string name_;
  BufferHandle handle_;
  std::size_t capacity_ = 0;
  int generation_ = 0;
};

}  // namespace collidoscope::gl
