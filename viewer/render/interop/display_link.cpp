#include "viewer/render/interop/display_link.h"

#include <algorithm>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

DisplayPath best_path(const World& world, DisplayPath request) {
  if (!world.info().on_gpu) return DisplayPath::upload;
  return request == DisplayPath::automatic ? DisplayPath::interop : request;
}

}  // namespace

DisplayLink::DisplayLink(const World& world, DisplayPath request, LogCallback log)
    : path_(best_path(world, request)), log_(std::move(log)) {
  const WorldInfo info = world.info();
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
  PublishCounts counts = world.publisher().counts(layers.first_level, layers.boxes ? layers.last_level : -1);
  if (!layers.spheres) counts.bodies = 0;
  if (!layers.contacts) counts.contacts = 0;
  if (!layers.joints) counts.joints = 0;
  buffers.counts = counts;
  buffers.level_sizes.clear();
  if (layers.boxes) {
    const std::vector<std::int64_t> sizes = world.tree().level_sizes();
    for (int level = layers.first_level; level <= layers.last_level; ++level)
      if (level < static_cast<int>(sizes.size()))
        buffers.level_sizes.push_back(sizes[static_cast<std::size_t>(level)]);
  }
  buffers.bodies.reserve(static_cast<std::size_t>(counts.bodies) * sizeof(BodyInstance));
  buffers.boxes.reserve(static_cast<std::size_t>(counts.boxes) * sizeof(BoxInstance));
  buffers.contacts.reserve(static_cast<std::size_t>(counts.contacts) * sizeof(ContactInstance));
  buffers.joints.reserve(static_cast<std::size_t>(counts.joints) * sizeof(JointInstance));
  PublishTarget target;
  target.body_capacity = counts.bodies;
  target.body_color = layers.color;
  target.box_capacity = counts.boxes;
  target.box_metric = layers.box_color;
  target.first_level = layers.first_level;
  target.last_level = layers.last_level;
  target.contact_capacity = counts.contacts;
  target.joint_capacity = counts.joints;
  if (path_ == DisplayPath::interop && publish_mapped(world, target, buffers)) return;
  publish_uploaded(world, target, buffers);
}

bool DisplayLink::publish_mapped(World& world, PublishTarget target, const InstanceBuffers& buffers) {
  try {
    const CudaGlBuffers::Addresses at = shared_->map(buffers);
    if (target.body_capacity) target.bodies = static_cast<BodyInstance*>(at[0]);
    if (target.box_capacity) target.boxes = static_cast<BoxInstance*>(at[1]);
    if (target.contact_capacity) target.contacts = static_cast<ContactInstance*>(at[2]);
    if (target.joint_capacity) target.joints = static_cast<JointInstance*>(at[3]);
  } catch (const MachineError& error) {
    step_down(error.what(), DisplayPath::copy);
    return false;
  }
  world.publisher().publish(target);
  shared_->unmap();
  return true;
}

void DisplayLink::publish_uploaded(World& world, PublishTarget target, InstanceBuffers& buffers) {
  struct Part {
    std::size_t bytes;
    gl::Buffer* to;
    void* at = nullptr;
  };
  Part parts[] = {
      {static_cast<std::size_t>(target.body_capacity) * sizeof(BodyInstance), &buffers.bodies},
      {static_cast<std::size_t>(target.box_capacity) * sizeof(BoxInstance), &buffers.boxes},
      {static_cast<std::size_t>(target.contact_capacity) * sizeof(ContactInstance), &buffers.contacts},
      {static_cast<std::size_t>(target.joint_capacity) * sizeof(JointInstance), &buffers.joints}};
  // On the CPU the scratch memory is host memory and is uploaded directly.
  for (int slot = 0; slot < 4; ++slot)
    if (parts[slot].bytes) parts[slot].at = world.publisher().scratch(parts[slot].bytes, slot);
  target.bodies = static_cast<BodyInstance*>(parts[0].at);
  target.boxes = static_cast<BoxInstance*>(parts[1].at);
  target.contacts = static_cast<ContactInstance*>(parts[2].at);
  target.joints = static_cast<JointInstance*>(parts[3].at);
  world.publisher().publish(target);
  for (const Part& part : parts) {
    if (!part.bytes) continue;
    const void* source = part.at;
    if (world.info().on_gpu) {
      host_.resize(std::max(host_.size(), part.bytes));
      world.publisher().copy_to_host(host_.data(), part.at, part.bytes);
      source = host_.data();
    }
    part.to->upload(source, part.bytes);
  }
}

}  // namespace collidoscope
