#pragma once
// Transfers draw records of a World to the drawn buffers, by the best path that works.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim_cuda/run/published_records.h"
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

  /// If the requested path fails, the next one is used; `log` receives one line per fallback. `info`: of the
  /// World whose records are shown.
  DisplayLink(const WorldInfo& info, DisplayPath request, LogCallback log);

  DisplayPath path() const { return path_; }
  /// Copies the records to the buffers, and sets the counts of the buffers.
  void show(const PublishedRecords& records, InstanceBuffers& buffers);
  /// The same for the records of the enabled layers at the current state.
  void publish(World& world, const FrameLayers& layers, InstanceBuffers& buffers);

 private:
  void step_down(const std::string& why, DisplayPath to);

  DisplayPath path_;
  LogCallback log_;
  std::unique_ptr<CudaGlBuffers> shared_;
  PublishedRecords records_;     // of publish()
  std::vector<std::byte> host_;  // host copy for the upload
};

}  // namespace collidoscope
