#pragma once
// For each body, the contacts of a set that it takes part in, in increasing id of the other body: so a body
// can add up what they do to it, in an order that nothing changes. Owned by a solver; made anew for each list
// of contacts.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/solver/contact_degrees.h"

namespace collidoscope {

/// A body's part in a contact.
struct ContactEnd {
  std::uint32_t contact;  ///< number, or place
  bool second;            ///< the body is the contact's b, which gets what a gives

  template <class Real>
  SIM_HD Real sign() const {
    return second ? Real(1) : Real(-1);
  }
};

struct ContactsByBodyView {
  const std::uint32_t* count;  ///< per body
  const std::uint32_t* begin;  ///< per body, where its contacts start in `entry`; undefined where it has none
  const std::uint32_t* entry;  ///< twice the contact, and 1 more at its second body

  SIM_HD ContactEnd end(int body, std::uint32_t k) const {
    const std::uint32_t packed = entry[begin[body] + k];
    return {packed / 2, packed % 2 != 0};
  }
};

class ContactsByBody {
 public:
  explicit ContactsByBody(Executor& executor);
  void reserve(std::int64_t bodies, std::int64_t contact_capacity);
  /// Lists the set, whose degrees are counted already, as part of that stage. `place`: what to list instead
  /// of a contact's number; null: the number.
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
