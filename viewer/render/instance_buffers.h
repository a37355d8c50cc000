#pragma once
// GL buffers with the drawn records. Owns the buffers. The display path (interop/) fills them; tests fill
// them from host arrays.

#include <cstdint>
#include <span>
#include <vector>

#include "sim_cuda/publish/publish.h"
#include "viewer/render/gl/buffer.h"

namespace collidoscope {

struct InstanceBuffers {
  gl::Buffer bodies{"bodies"}, boxes{"boxes"}, contacts{"contacts"}, joints{"joints"};
  PublishCounts counts;                   ///< number of records in each buffer
  std::vector<std::int64_t> level_sizes;  ///< number of boxes per level, in order; the sum is counts.boxes

  void upload(std::span<const BodyInstance> records) {
    bodies.upload(records.data(), records.size_bytes());
    counts.bodies = static_cast<std::int64_t>(records.size());
  }
  void upload(std::span<const BoxInstance> records) {
    boxes.upload(records.data(), records.size_bytes());
    counts.boxes = static_cast<std::int64_t>(records.size());
    level_sizes.clear();
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (i == 0 || records[i].level > records[i - 1].level) level_sizes.push_back(0);
      ++level_sizes.back();
    }
  }
  void upload(std::span<const ContactInstance> records) {
    contacts.upload(records.data(), records.size_bytes());
    counts.contacts = static_cast<std::int64_t>(records.size());
  }
  void upload(std::span<const JointInstance> records) {
    joints.upload(records.data(), records.size_bytes());
    counts.joints = static_cast<std::int64_t>(records.size());
  }
};

}  // namespace collidoscope
