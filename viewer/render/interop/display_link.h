#pragma once
// Transfers the published records of a World to the drawn buffers, by the best path that works.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim_cuda/world.h"
#include "viewer/render/frame_layers.h"
#include "viewer/render/instance_buffers.h"
#include "viewer/render/interop/cuda_gl.h"
#include "viewer/render/interop/display_path.h"

namespace collidoscope {

/// Requires the GL context of its construction. Keeps no reference to the World.
class DisplayLink {
 public:
  using LogCallback = std::function<void(const std::string& line)>;

  /// If the requested path fails, the next one is used; `log` receives one line per fallback.
  DisplayLink(const World& world, DisplayPath request, LogCallback log);

  DisplayPath path() const { return path_; }
  /// Publishes the records of the enabled layers for the current state, and sets the counts of the buffers.
  void publish(World& world, const FrameLayers& layers, InstanceBuffers& buffers);

 private:
  void step_down(const std::string& why, DisplayPath to);
  bool publish_mapped(World& world, PublishTarget target, const InstanceBuffers& buffers);
  void publish_uploaded(World& world, PublishTarget target, InstanceBuffers& buffers);

  DisplayPath path_;
  LogCallback log_;
  std::unique_ptr<CudaGlBuffers> shared_;
  std::vector<std::byte> host_;  // host copy for the upload
};

}  // namespace collidoscope
