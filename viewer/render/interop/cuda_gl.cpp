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
  bool mapped = false;

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
  if (impl_->mapped) unmap();
  for (std::size_t i = 0; i < 4; ++i) impl_->unregister(i);
}

CudaGlBuffers::Addresses CudaGlBuffers::map(const InstanceBuffers& buffers) {
  Impl& m = *impl_;
  check(cudaSetDevice(m.gpu), "use device " + std::to_string(m.gpu));
  const std::array<const gl::Buffer*, 4> sources{&buffers.bodies, &buffers.boxes, &buffers.contacts,
                                                 &buffers.joints};
  for (std::size_t i = 0; i < 4; ++i) {
    if (m.generations[i] == sources[i]->generation()) continue;
    m.unregister(i);
    check(cudaGraphicsGLRegisterBuffer(&m.resources[i], sources[i]->get(),
                                       cudaGraphicsRegisterFlagsWriteDiscard),
          "register a GL buffer of " + std::to_string(sources[i]->capacity()) + " bytes");
    m.generations[i] = sources[i]->generation();
  }
  check(cudaGraphicsMapResources(4, m.resources.data(), nullptr), "map four GL buffers");
  m.mapped = true;
  // Mapping synchronises only the default stream, but the simulator uses streams of its own.
  check(cudaStreamSynchronize(nullptr), "wait for OpenGL");
  Addresses addresses{};
  for (std::size_t i = 0; i < 4; ++i) {
    std::size_t bytes = 0;
    check(cudaGraphicsResourceGetMappedPointer(&addresses[i], &bytes, m.resources[i]),
          "query the address of a mapped GL buffer");
    if (bytes < sources[i]->capacity())
      throw MachineError("CUDA mapped " + std::to_string(bytes) + " bytes of a GL buffer of " +
                         std::to_string(sources[i]->capacity()));
  }
  return addresses;
}

void CudaGlBuffers::unmap() {
  impl_->mapped = false;
  check(cudaGraphicsUnmapResources(4, impl_->resources.data(), nullptr), "unmap four GL buffers");
}

}  // namespace collidoscope

#else

namespace collidoscope {

struct CudaGlBuffers::Impl {};

CudaGlBuffers::CudaGlBuffers(int) { throw MachineError("this build has no CUDA support"); }
CudaGlBuffers::~CudaGlBuffers() = default;
CudaGlBuffers::Addresses CudaGlBuffers::map(const InstanceBuffers&) {
  throw MachineError("this build has no CUDA");
}
void CudaGlBuffers::unmap() {}

}  // namespace collidoscope

#endif
