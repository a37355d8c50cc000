#pragma once
// For each body, its contacts in a contact set, in increasing id of the other body. The fixed order makes
// sums over the contacts of a body deterministic. Owned by a solver; rebuilt for each contact list.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/solver/contact_degrees.h"

namespace collidoscope {

/// One end of a contact.
struct ContactEnd {
  std::uint32_t contact;  ///< contact number or place
  bool second;            ///< true: the body is b, which gets the positive impulse

  template <class Real>
  SIM_HD Real sign() const {
    return second ? Real(1) : Real(-1);
  }
};

struct ContactsByBodyView {
  const std::uint32_t* count;  ///< per body
  const std::uint32_t* begin;  ///< per body, start of its contacts in `entry`; undefined if count is 0
  const std::uint32_t* entry;  ///< 2 * contact; + 1 if the body is b

  SIM_HD ContactEnd end(int body, std::uint32_t k) const {
    const std::uint32_t packed = entry[begin[body] + k];
    return {packed / 2, packed % 2 != 0};
  }
};

class ContactsByBody {
 public:
  explicit ContactsByBody(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Builds the lists of `set`. Precondition: `degrees` has counted `set`. `stage`: name for timing.
  /// `place`: values stored instead of contact numbers, by contact; null: contact numbers.
  void list(const char* stage, const ContactSet& set, const ContactDegrees& degrees,
            const std::uint32_t* place = nullptr);
  ContactsByBodyView view(const ContactDegrees& degrees) const {
    return {degrees.view().count, degrees.view().begin, entry_.data()};
  }

 private:
  Executor& executor_;
  std::int64_t contact_capacity_ = 0;
  Buffer<std::uint32_t> filled_, entry_;
};

}  // namespace collidoscope
