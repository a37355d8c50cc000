#pragma once
// Draw records of one state, copied into memory of their own. A renderer can read them while the World makes
// further steps, also after the World is gone.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "sim_cuda/publish/frame_layers.h"
#include "sim_cuda/publish/publish.h"

namespace collidoscope {

struct ReleaseRecordMemory {
  int gpu = -1;  ///< -1: host memory
  void operator()(void* memory) const;
};

/// Memory of the host or of a CUDA device. Growing discards the contents.
class RecordMemory {
 public:
  /// Throws MachineError if there is no memory. `gpu`: CUDA device; -1: host.
  void reserve(std::size_t bytes, int gpu);
  void* data() const { return memory_.get(); }

 private:
  std::unique_ptr<void, ReleaseRecordMemory> memory_;
  std::size_t bytes_ = 0;
};

/// Number of drawn records, and of boxes per drawn level.
struct DrawnCounts {
  PublishCounts records;
  std::vector<std::int64_t> level_sizes;
};

/// Filled by Publisher::copy().
class PublishedRecords {
 public:
  /// Reserves memory, and returns the target for publish(). `gpu`: CUDA device; -1: host.
  PublishTarget prepare(DrawnCounts counts, const FrameLayers& layers, int gpu);

  const DrawnCounts& counts() const { return counts_; }
  /// CUDA device of the memory; -1: host.
  int gpu() const { return gpu_; }
  struct Part {
    const void* data;
    std::size_t bytes;
  };
  /// Bodies, boxes, contacts and joints.
  std::array<Part, 4> parts() const;
  /// Copies a part to host memory. Throws MachineError.
  void read(std::size_t part, void* host) const;
  /// The records of a kind on the host. Throws MachineError.
  template <class Record>
  std::vector<Record> copy() const {
    constexpr std::size_t part = std::is_same_v<Record, BodyInstance>      ? 0
                                 : std::is_same_v<Record, BoxInstance>     ? 1
                                 : std::is_same_v<Record, ContactInstance> ? 2
                                                                           : 3;
    std::vector<Record> records(parts()[part].bytes / sizeof(Record));
    if (!records.empty()) read(part, records.data());
    return records;
  }

 private:
  DrawnCounts counts_;
  int gpu_ = -1;
  std::array<RecordMemory, 4> memory_;
};

}  // namespace collidoscope
