#include "viewer/render/interop/cuda_gl.h"

#include "sim_cuda/core/error.h"

#if SIM_CUDA
// epoxy must come first, since the interop header includes GL/gl.h.
#include <cuda_gl_interop.h>
#include <cuda_runtime_api.h>

#include <algorithm>
#include <string>
#include <vector>

#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

void check(cudaError_t code, const std::string& what) {
  if (code == cudaSuccess) return;
  cudaGetLastError();  // clears the reported error, so that the simulator does not see it
  throw MachineError("CUDA: cannot " + what + ": " + cudaGetErrorString(code));
}

}  // namespace

struct CudaGlBuffers::Impl {
  int gpu = 0;
  std::array<cudaGraphicsResource_t, 4> resources{};
  std::array<int, 4> generations{};  // 0: not registered

  void unregister(std::size_t i) {
    if (resources[i]) cudaGraphicsUnregisterResource(resources[i]);
    resources[i] = nullptr;
    generations[i] = 0;
  }
};

CudaGlBuffers::CudaGlBuffers(int gpu) : impl_(std::make_unique<Impl>()) {
  impl_->gpu = gpu;
  unsigned count = 0;
  std::vector<int> devices(64);
  const cudaError_t code =
      cudaGLGetDevices(&count, devices.data(), static_cast<unsigned>(devices.size()), cudaGLDeviceListAll);
  devices.resize(code == cudaSuccess ? count : 0);
  if (std::find(devices.begin(), devices.end(), gpu) == devices.end()) {
    cudaGetLastError();
    throw MachineError("OpenGL draws on " + gl::renderer_name() + ", which is not CUDA device " +
                       std::to_string(gpu) +
                       (code == cudaSuccess ? "" : std::string(" (") + cudaGetErrorString(code) + ")"));
  }
}

CudaGlBuffers::~CudaGlBuffers() {
  for (std::size_t i = 0; i < 4; ++i) impl_->unregister(i);
}

void CudaGlBuffers::copy(const std::array<PublishedRecords::Part, 4>& parts, const InstanceBuffers& buffers) {
  Impl& m = *impl_;
  check(cudaSetDevice(m.gpu), "use device " + std::to_string(m.gpu));
  const std::array<const gl::Buffer*, 4> to{&buffers.bodies, &buffers.boxes, &buffers.contacts,
                                            &buffers.joints};
  for (std::size_t i = 0; i < 4; ++i) {
    if (m.generations[i] == to[i]->generation()) continue;
    m.unregister(i);
    check(cudaGraphicsGLRegisterBuffer(&m.resources[i], to[i]->get(), cudaGraphicsRegisterFlagsWriteDiscard),
          "register a GL buffer of " + std::to_string(to[i]->capacity()) + " bytes");
    m.generations[i] = to[i]->generation();
  }
  check(cudaGraphicsMapResources(4, m.resources.data(), nullptr), "map four GL buffers");
  const auto copy_all = [&] {
    for (std::size_t i = 0; i < 4; ++i) {
      if (parts[i].bytes == 0) continue;
      void* address = nullptr;
      std::size_t bytes = 0;
      check(cudaGraphicsResourceGetMappedPointer(&address, &bytes, m.resources[i]),
            "query the address of a mapped GL buffer");
      if (bytes < parts[i].bytes)
        throw MachineError("CUDA mapped " + std::to_string(bytes) + " bytes of a GL buffer, expected " +
                           std::to_string(parts[i].bytes));
      check(cudaMemcpyAsync(address, parts[i].data, parts[i].bytes, cudaMemcpyDeviceToDevice, nullptr),
            "copy to a GL buffer");
    }
  };
  try {
    copy_all();
  } catch (...) {
    cudaGraphicsUnmapResources(4, m.resources.data(), nullptr);
    throw;
  }
  check(cudaGraphicsUnmapResources(4, m.resources.data(), nullptr), "unmap four GL buffers");
  // The source is overwritten by the next publication.
  check(cudaStreamSynchronize(nullptr), "wait for the copies");
}

}  // namespace collidoscope

#else

namespace collidoscope {

struct CudaGlBuffers::Impl {};

CudaGlBuffers::CudaGlBuffers(int) { throw MachineError("this build has no CUDA support"); }
CudaGlBuffers::~CudaGlBuffers() = default;
void CudaGlBuffers::copy(const std::array<PublishedRecords::Part, 4>&, const InstanceBuffers&) {
  throw MachineError("this build has no CUDA support");
}

}  // namespace collidoscope

#endif
