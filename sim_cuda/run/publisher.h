#pragma once
// Writes what is drawn of a world into memory of the caller (sim_cuda/publish/publish.h), and has the memory
// that a renderer needs for that.

#include <cstddef>
#include <memory>
#include <vector>

#include "sim_cuda/publish/publish.h"

namespace collidoscope {

template <class T>
class Buffer;
class Simulation;

/// A part of World: World::publisher().
class Publisher {
 public:
  explicit Publisher(Simulation& run);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Of the current state, which it detects; contacts are the pairs that touch. An empty range: no boxes.
  PublishCounts counts(int first_level, int last_level);
  /// Packs what is drawn into the target's memory; returns when the device has written it. Throws
  /// std::logic_error where the target is smaller than counts() says.
  void publish(const PublishTarget& target);

  /// How far each body is from where it should be, m, by id, according to a reference: what BodyColor::error
  /// shows from now on. Other than N of them: 0 for all.
  void set_errors(std::vector<float> errors);
  const std::vector<float>& errors() const { return errors_; }  ///< as they were set

  /// Memory in the executor's space for a renderer that cannot map its own: a device allocation on a GPU,
  /// else plain memory. Freed with the World.
  void* scratch(std::size_t bytes, int slot);
  /// Copies from the executor's memory space to the host.
  void copy_to_host(void* host, const void* source, std::size_t bytes);

 private:
  Simulation& run_;
  std::vector<std::unique_ptr<Buffer<std::byte>>> scratch_;
  std::vector<float> errors_;                    ///< of bodies, m
  std::unique_ptr<Buffer<float>> drawn_errors_;  ///< made when they are first drawn
};

}  // namespace collidoscope
