#pragma once
// Writes draw records of a world into memory of the caller (sim_cuda/publish/publish.h).

#include <cstddef>
#include <memory>
#include <vector>

#include "sim_cuda/publish/frame_layers.h"
#include "sim_cuda/publish/publish.h"
#include "sim_cuda/run/published_records.h"

namespace collidoscope {

template <class T>
class Buffer;
class Simulation;

/// Part of World: World::publisher().
class Publisher {
 public:
  explicit Publisher(Simulation& run);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Record counts of the current state; calls detect(). Contacts are touching pairs. An empty level range
  /// gives no boxes.
  PublishCounts counts(int first_level, int last_level);
  /// Packs the draw records into the target's memory and waits for the device. Throws std::logic_error if a
  /// capacity is below counts().
  void publish(const PublishTarget& target);
  /// Copies the draw records of the enabled layers at the current state.
  void copy(const FrameLayers& layers, PublishedRecords& to);

  /// Sets the distance of each body from a reference, m, by id, for BodyColor::error. If the size is not N,
  /// all are 0.
  void set_errors(std::vector<float> errors);
  const std::vector<float>& errors() const { return errors_; }  ///< as set by set_errors()

 private:
  Simulation& run_;
  std::vector<float> errors_;                    ///< by body, m
  std::unique_ptr<Buffer<float>> drawn_errors_;  ///< created at the first use
};

}  // namespace collidoscope
