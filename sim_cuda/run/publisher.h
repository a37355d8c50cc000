#pragma once
// Writes draw records of a world into memory of the caller (sim_cuda/publish/publish.h). Provides executor
// memory for renderers.

#include <cstddef>
#include <memory>
#include <vector>

#include "sim_cuda/publish/publish.h"

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

  /// Sets the distance of each body from a reference, m, by id, for BodyColor::error. If the size is not N,
  /// all are 0.
  void set_errors(std::vector<float> errors);
  const std::vector<float>& errors() const { return errors_; }  ///< as set by set_errors()

  /// Memory in the executor's space for a renderer that cannot map its own: device memory on a GPU,
  /// otherwise host memory. Freed with the World.
  void* scratch(std::size_t bytes, int slot);
  /// Copies from the executor's memory space to the host.
  void copy_to_host(void* host, const void* source, std::size_t bytes);

 private:
  Simulation& run_;
  std::vector<std::unique_ptr<Buffer<std::byte>>> scratch_;
  std::vector<float> errors_;                    ///< by body, m
  std::unique_ptr<Buffer<float>> drawn_errors_;  ///< created at the first use
};

}  // namespace collidoscope
