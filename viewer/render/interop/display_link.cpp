#include "viewer/render/interop/display_link.h"

#include <algorithm>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

DisplayPath best_path(const WorldInfo& info, DisplayPath request) {
  if (!info.on_gpu) return DisplayPath::upload;
  return request == DisplayPath::automatic ? DisplayPath::interop : request;
}

}  // namespace

DisplayLink::DisplayLink(const WorldInfo& info, DisplayPath request, LogCallback log)
    : path_(best_path(info, request)), log_(std::move(log)) {
  if (!info.on_gpu && (request == DisplayPath::interop || request == DisplayPath::copy))
    step_down("the simulation runs on the CPU", DisplayPath::upload);
  // The path `upload` needs a simulation on the CPU.
  if (info.on_gpu && request == DisplayPath::upload)
    step_down("the simulation runs on the GPU", DisplayPath::copy);
  if (path_ != DisplayPath::interop) return;
  try {
    shared_ = std::make_unique<CudaGlBuffers>(info.gpu);
  } catch (const MachineError& error) {
    step_down(error.what(), DisplayPath::copy);
  }
}

void DisplayLink::step_down(const std::string& why, DisplayPath to) {
  shared_.reset();
  path_ = to;
  log_("display path: " + why + "; using " + display_path_name(to) + " instead");
}

void DisplayLink::publish(World& world, const FrameLayers& layers, InstanceBuffers& buffers) {
  world.publisher().copy(layers, records_);
  show(records_, buffers);
}

void DisplayLink::show(const PublishedRecords& records, InstanceBuffers& buffers) {
  buffers.counts = records.counts().records;
  buffers.level_sizes = records.counts().level_sizes;
  const std::array<PublishedRecords::Part, 4> parts = records.parts();
  const std::array<gl::Buffer*, 4> to{&buffers.bodies, &buffers.boxes, &buffers.contacts, &buffers.joints};
  for (std::size_t k = 0; k < 4; ++k) to[k]->reserve(parts[k].bytes);
  try {
    if (path_ == DisplayPath::interop) return shared_->copy(parts, buffers);
  } catch (const MachineError& error) {
    step_down(error.what(), DisplayPath::copy);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    if (parts[k].bytes == 0) continue;
    const void* source = parts[k].data;
    if (records.gpu() >= 0) {
      host_.resize(std::max(host_.size(), parts[k].bytes));
      records.read(k, host_.data());
      source = host_.data();
    }
    to[k]->upload(source, parts[k].bytes);
  }
}

}  // namespace collidoscope
