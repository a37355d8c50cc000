#pragma once
// GL buffers that CUDA writes into. Compiles without CUDA: then every call throws MachineError.

#include <array>
#include <memory>

#include "viewer/render/instance_buffers.h"

namespace collidoscope {

/// Registrations of the three instance buffers with one CUDA device; each is renewed when its buffer grows.
/// Lives no longer than the GL context and the buffers.
class CudaGlBuffers {
 public:
  /// Throws MachineError where the current GL context does not draw on CUDA device `gpu`.
  explicit CudaGlBuffers(int gpu);
  ~CudaGlBuffers();

  /// The device addresses of bodies, boxes, contacts and joints, valid until unmap(). OpenGL has finished
  /// with them, and CUDA may write from any stream. Throws MachineError.
  using Addresses = std::array<void*, 4>;
  Addresses map(const InstanceBuffers& buffers);
  void unmap();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collidoscope
