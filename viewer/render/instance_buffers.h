#pragma once
// The GL buffers that hold what is drawn. Owned here; filled by the display path (interop/) or, in tests,
// from host arrays.

#include <cstdint>
#include <span>
#include <vector>

#include "sim_cuda/publish/publish.h"
#include "viewer/render/gl/buffer.h"

namespace collidoscope {

struct InstanceBuffers {
  gl::Buffer bodies{"bodies"}, boxes{"boxes"}, contacts{"contacts"}, joints{"joints"};
  PublishCounts counts;  ///< records in each that are drawn
  std::vector<std::int64_t>
      level_sizes;  ///< of the boxes, which come level by level; their sum is counts.boxes

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
