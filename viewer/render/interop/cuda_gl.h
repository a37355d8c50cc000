#pragma once
// Copies draw records from device memory to GL buffers. Without CUDA every call throws MachineError.

#include <array>
#include <memory>

#include "sim_cuda/run/published_records.h"
#include "viewer/render/instance_buffers.h"

namespace collidoscope {

/// Registrations of the instance buffers with one CUDA device, renewed when a buffer grows. Must not outlive
/// the GL context and the buffers.
class CudaGlBuffers {
 public:
  /// Throws MachineError if the current GL context does not run on CUDA device `gpu`.
  explicit CudaGlBuffers(int gpu);
  ~CudaGlBuffers();

  /// Copies bodies, boxes, contacts and joints to the buffers, and waits for the copies. Precondition: the
  /// buffers are large enough. Throws MachineError.
  void copy(const std::array<PublishedRecords::Part, 4>& parts, const InstanceBuffers& buffers);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collidoscope
