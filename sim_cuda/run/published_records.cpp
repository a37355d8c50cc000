#include "sim_cuda/run/published_records.h"

#include <cstring>
#include <new>
#include <string>

#include "sim_cuda/core/cuda_check.h"

namespace collidoscope {
namespace {

std::array<std::size_t, 4> bytes_of(const PublishCounts& counts) {
  const auto bytes = [](std::int64_t records, std::size_t size) {
    return static_cast<std::size_t>(records) * size;
  };
  return {bytes(counts.bodies, sizeof(BodyInstance)), bytes(counts.boxes, sizeof(BoxInstance)),
          bytes(counts.contacts, sizeof(ContactInstance)), bytes(counts.joints, sizeof(JointInstance))};
}

}  // namespace

void ReleaseRecordMemory::operator()(void* memory) const {
#if SIM_CUDA
  if (gpu >= 0) {
    cudaFree(memory);  // at the end of the process there may be no device left
    return;
  }
#endif
  ::operator delete(memory);
}

void RecordMemory::reserve(std::size_t bytes, int gpu) {
  if (memory_ && bytes_ >= bytes && memory_.get_deleter().gpu == gpu) return;
  memory_.reset();
  bytes_ = bytes + bytes / 4;
  void* memory = nullptr;
  if (gpu < 0) {
    memory = ::operator new(bytes_);
  } else {
#if SIM_CUDA
    check(cudaSetDevice(gpu), "use the device");
    check(cudaMalloc(&memory, bytes_), "allocate " + std::to_string(bytes_) + " bytes for draw records");
#endif
  }
  memory_ = {memory, ReleaseRecordMemory{gpu}};
}

DrawnCounts drawn_counts(World& world, const FrameLayers& layers) {
  DrawnCounts drawn;
  drawn.records = world.publisher().counts(layers.first_level, layers.boxes ? layers.last_level : -1);
  if (!layers.spheres) drawn.records.bodies = 0;
  if (!layers.contacts) drawn.records.contacts = 0;
  if (!layers.joints) drawn.records.joints = 0;
  if (!layers.boxes) return drawn;
  const std::vector<std::int64_t> sizes = world.tree().level_sizes();
  for (int level = layers.first_level; level <= layers.last_level; ++level)
    if (level < static_cast<int>(sizes.size()))
      drawn.level_sizes.push_back(sizes[static_cast<std::size_t>(level)]);
  return drawn;
}

PublishTarget publish_target(const PublishCounts& counts, const FrameLayers& layers) {
  PublishTarget target;
  target.body_capacity = counts.bodies;
  target.body_color = layers.color;
  target.box_capacity = counts.boxes;
  target.box_metric = layers.box_color;
  target.first_level = layers.first_level;
  target.last_level = layers.last_level;
  target.contact_capacity = counts.contacts;
  target.joint_capacity = counts.joints;
  return target;
}

void PublishedRecords::pack(World& world, const FrameLayers& layers) {
  counts_ = drawn_counts(world, layers);
  gpu_ = world.info().gpu;
  PublishTarget target = publish_target(counts_.records, layers);
  const std::array<std::size_t, 4> bytes = bytes_of(counts_.records);
  for (std::size_t k = 0; k < 4; ++k)
    if (bytes[k] > 0) memory_[k].reserve(bytes[k], gpu_);
  if (bytes[0] > 0) target.bodies = static_cast<BodyInstance*>(memory_[0].data());
  if (bytes[1] > 0) target.boxes = static_cast<BoxInstance*>(memory_[1].data());
  if (bytes[2] > 0) target.contacts = static_cast<ContactInstance*>(memory_[2].data());
  if (bytes[3] > 0) target.joints = static_cast<JointInstance*>(memory_[3].data());
  world.publisher().publish(target);
}

std::array<PublishedRecords::Part, 4> PublishedRecords::parts() const {
  const std::array<std::size_t, 4> bytes = bytes_of(counts_.records);
  std::array<Part, 4> parts{};
  for (std::size_t k = 0; k < 4; ++k) parts[k] = {memory_[k].data(), bytes[k]};
  return parts;
}

void PublishedRecords::read(std::size_t part, void* host) const {
  const Part from = parts()[part];
#if SIM_CUDA
  if (gpu_ >= 0) {
    check(cudaSetDevice(gpu_), "use the device");
    return check(cudaMemcpy(host, from.data, from.bytes, cudaMemcpyDeviceToHost),
                 "copy draw records to the host");
  }
#endif
  std::memcpy(host, from.data, from.bytes);
}

}  // namespace collidoscope
