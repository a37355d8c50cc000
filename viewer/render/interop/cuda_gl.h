#pragma once
// GL buffers that CUDA writes into. Without CUDA every call throws MachineError.

#include <array>
#include <memory>

#include "viewer/render/instance_buffers.h"

namespace collidoscope {

/// Registrations of the instance buffers with one CUDA device, renewed when a buffer grows. Must not outlive
/// the GL context and the buffers.
class CudaGlBuffers {
 public:
  /// Throws MachineError if the current GL context does not run on CUDA device `gpu`.
  explicit CudaGlBuffers(int gpu);
  ~CudaGlBuffers();

  /// Device addresses of bodies, boxes, contacts and joints, valid until unmap(). OpenGL has finished
  /// reading, and CUDA may write from any stream. Throws MachineError.
  using Addresses = std::array<void*, 4>;
  Addresses map(const InstanceBuffers& buffers);
  void unmap();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collidoscope
