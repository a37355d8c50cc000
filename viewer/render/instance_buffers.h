#pragma once
// The GL buffers that hold what is drawn. Owned here; filled by the display path (interop/) or, in tests,
// from host arrays.

#include <cstdint>
#include <span>

#include "sim_cuda/publish.h"
#include "viewer/render/gl/buffer.h"

namespace collidoscope {

struct InstanceBuffers {
  gl::Buffer bodies{"bodies"}, boxes{"boxes"}, contacts{"contacts"};
  PublishCounts counts;  ///< records in each that are drawn

  void upload(std::span<const BodyInstance> records) {
    bodies.upload(records.data(), records.size_bytes());
    counts.bodies = static_cast<std::int64_t>(records.size());
  }
  void upload(std::span<const BoxInstance> records) {
    boxes.upload(records.data(), records.size_bytes());
    counts.boxes = static_cast<std::int64_t>(records.size());
  }
  void upload(std::span<const ContactInstance> records) {
    contacts.upload(records.data(), records.size_bytes());
    counts.contacts = static_cast<std::int64_t>(records.size());
  }
};

}  // namespace collidoscope
