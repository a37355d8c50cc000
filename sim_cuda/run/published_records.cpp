#include "sim_cuda/run/published_records.h"

#include <cstring>
#include <new>
#include <string>
#include <utility>

#include "sim_cuda/core/compute_device.h"
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
    if (!gpu_abandoned()) cudaFree(memory);  // at the end of the process there may be no device left
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

PublishTarget PublishedRecords::prepare(DrawnCounts counts, const FrameLayers& layers, int gpu) {
  counts_ = std::move(counts);
  gpu_ = gpu;
  const PublishCounts& records = counts_.records;
  const std::array<std::size_t, 4> bytes = bytes_of(records);
  std::array<void*, 4> at{};
  for (std::size_t k = 0; k < 4; ++k) {
    if (bytes[k] == 0) continue;
    memory_[k].reserve(bytes[k], gpu);
    at[k] = memory_[k].data();
  }
  PublishTarget target;
  target.bodies = static_cast<BodyInstance*>(at[0]);
  target.body_capacity = records.bodies;
  target.body_color = layers.color;
  target.boxes = static_cast<BoxInstance*>(at[1]);
  target.box_capacity = records.boxes;
  target.box_metric = layers.box_color;
  target.first_level = layers.first_level;
  target.last_level = layers.last_level;
  target.contacts = static_cast<ContactInstance*>(at[2]);
  target.contact_capacity = records.contacts;
  target.joints = static_cast<JointInstance*>(at[3]);
  target.joint_capacity = records.joints;
  return target;
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
