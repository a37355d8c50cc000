#pragma once
// The stages that look one body up on the device (World::inspect). Included by pipeline.cpp alone.

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"

namespace collidoscope {

struct FindLeaf {
  const std::uint32_t* leaf_body;
  std::uint32_t body;
  std::uint32_t* leaf;
  SIM_HD void operator()(int k) const {
    if (leaf_body[k] == body) *leaf = static_cast<std::uint32_t>(k);
  }
};

/// The contacts of one body, in any order; `count` goes beyond the capacity where there are more.
struct FindContacts {
  const Pair* contacts;
  std::uint32_t body;
  std::uint32_t *count, *found;
  std::uint32_t capacity;
  SIM_HD void operator()(int contact) const {
    const auto [a, b] = contacts[contact];
    if (a != body && b != body) return;
    const std::uint32_t place = atomic_add(count, 1);
    if (place < capacity) found[place] = a == body ? b : a;
  }
};

}  // namespace collidoscope
