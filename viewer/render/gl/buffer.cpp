#include "viewer/render/gl/buffer.h"

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope::gl {

void Buffer::reserve(std::size_t bytes) {
  bytes = std::max<std::size_t>(bytes, 16);
  if (bytes <= capacity_) return;
  bytes = std::max(bytes,
                   capacity_ + capacity_ / 2);  // grows by at least half of its size, so that growing is rare
  GLuint name = 0;
  glCreateBuffers(1, &name);
  handle_ = BufferHandle(name);
  glNamedBufferStorage(name, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT);
  check("allocate " + std::to_string(bytes) + " bytes for the buffer '" + name_ + "'");
  capacity_ = bytes;
  ++generation_;
}

void Buffer::upload(const void* data, std::size_t bytes) {
  reserve(bytes);
  if (bytes) glNamedBufferSubData(get(), 0, static_cast<GLsizeiptr>(bytes), data);
  check("upload " + std::to_string(bytes) + " bytes to the buffer '" + name_ + "'");
}

void Buffer::read(void* data, std::size_t bytes) const {
  if (bytes > capacity_)
    throw MachineError("the buffer '" + name_ + "' holds " + std::to_string(capacity_) + " bytes, not " +
                       std::to_string(bytes));
  if (bytes) glGetNamedBufferSubData(get(), 0, static_cast<GLsizeiptr>(bytes), data);
  check("read " + std::to_string(bytes) + " bytes of the buffer '" + name_ + "'");
}

}  // namespace collidoscope::gl
