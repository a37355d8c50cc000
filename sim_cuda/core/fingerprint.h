#pragma once
// Checksum of a file's contents: a hash over 8-byte words in order.

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "sim_cuda/core/hash.h"

namespace collidoscope {

class Fingerprint {
 public:
  static constexpr std::size_t word = 8;
  /// Precondition: `bytes` is a multiple of `word`.
  void add(const void* data, std::size_t bytes) {
    for (std::size_t at = 0; at < bytes; at += word) {
      std::uint64_t next = 0;
      std::memcpy(&next, static_cast<const char*>(data) + at, word);
      hash_ = mix64(hash_ ^ next);
    }
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0;
};

}  // namespace collidoscope
