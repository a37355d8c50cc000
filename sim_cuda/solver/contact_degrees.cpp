#include "sim_cuda/solver/contact_degrees.h"

#include "sim_cuda/core/atomics.h"

namespace collidoscope {

namespace {

struct BeginCounts {
  const std::uint32_t* contacts;
  std::uint32_t bodies;
  std::uint32_t* items;
  SIM_HD void operator()(int) const {
    items[0] = *contacts > 0 ? bodies : 0;
    items[1] = 0;
  }
};

struct ClearCounts {
  std::uint32_t* count;
  SIM_HD void operator()(int body) const { count[body] = 0; }
};

struct CountContactsOfBodies {
  ContactSet set;
  std::uint32_t* count;
  SIM_HD void operator()(int item) const {
    const auto [a, b] = set.contacts[set.number(item)];
    atomic_add(&count[a], 1);
    atomic_add(&count[b], 1);
  }
};

/// The order of the segments is not deterministic. It does not affect the state.
struct PlaceEntries {
  const std::uint32_t* count;
  std::uint32_t *allocated, *begin;
  SIM_HD void operator()(int body) const {
    if (count[body] > 0) begin[body] = atomic_add_aggregated(allocated, count[body]);
  }
};

}  // namespace

ContactDegrees::ContactDegrees(Executor& executor)
    : executor_(executor),
      items_(executor, "size of contact lists by body"),
      count_(executor, "contact list sizes"),
      begin_(executor, "contact list starts") {}

void ContactDegrees::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  bodies_ = bodies;
  contact_capacity_ = contact_capacity;
  items_.resize_discarding(2);
  count_.resize_discarding(static_cast<std::size_t>(bodies));
  begin_.resize_discarding(static_cast<std::size_t>(bodies));
}

void ContactDegrees::count(const char* stage, const ContactSet& set) {
  executor_.run(stage, 1, BeginCounts{set.count, static_cast<std::uint32_t>(bodies_), items_.data()});
  executor_.run(stage, bodies(), ClearCounts{count_.data()});
  executor_.run(stage, ItemCount(set.count, contact_capacity_), CountContactsOfBodies{set, count_.data()});
  executor_.run(stage, bodies(), PlaceEntries{count_.data(), items_.data() + 1, begin_.data()});
}

}  // namespace collidoscope
