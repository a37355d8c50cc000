#pragma once
// Brings what a World publishes into the buffers that are drawn, by the best path that works.

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

/// Needs the GL context that was current when it was made. Keeps no reference to the World.
class DisplayLink {
 public:
  using LogCallback = std::function<void(const std::string& line)>;

  /// A path that was requested and fails is a step down like any other; `log` gets one line for each.
  DisplayLink(const World& world, DisplayPath request, LogCallback log);

  DisplayPath path() const { return path_; }
  /// Publishes the current state's records of the layers that are on, and sets the buffers' counts.
  void publish(World& world, const FrameLayers& layers, InstanceBuffers& buffers);

 private:
  void step_down(const std::string& why, DisplayPath to);
  bool publish_mapped(World& world, PublishTarget target, const InstanceBuffers& buffers);
  void publish_uploaded(World& world, PublishTarget target, InstanceBuffers& buffers);

  DisplayPath path_;
  LogCallback log_;
  std::unique_ptr<CudaGlBuffers> shared_;
  std::vector<std::byte> host_;  // what is uploaded
};

}  // namespace collidoscope
