#include "sim_cuda/solver/contacts_by_body.h"

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/segment_sort.h"

namespace collidoscope {

namespace {

struct BeginLists {
  const std::uint32_t* contacts;
  std::uint32_t bodies;
  std::uint32_t* items;
  SIM_HD void operator()(int) const {
    items[0] = *contacts > 0 ? bodies : 0;
    items[1] = 0;
  }
};

struct ClearLists {
  std::uint32_t *count, *filled;
  SIM_HD void operator()(int body) const { count[body] = filled[body] = 0; }
};

struct CountEntries {
  const Pair* contacts;
  const std::uint32_t *order, *begin;
  std::uint32_t* count;
  SIM_HD void operator()(int item) const {
    const auto [a, b] = contacts[order[*begin + static_cast<std::uint32_t>(item)]];
    atomic_add(&count[a], 1);
    atomic_add(&count[b], 1);
  }
};

/// Where a body's list stands is free: only its content reaches the state.
struct PlaceLists {
  const std::uint32_t* count;
  std::uint32_t *handed_out, *begin;
  SIM_HD void operator()(int body) const {
    if (count[body] > 0) begin[body] = atomic_add(handed_out, count[body]);
  }
};

struct FillLists {
  const Pair* contacts;
  const std::uint32_t *order, *set_begin, *begin;
  std::uint32_t *filled, *entry;
  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*set_begin + static_cast<std::uint32_t>(item)];
    const auto [a, b] = contacts[contact];
    entry[begin[a] + atomic_add(&filled[a], 1)] = contact;
    entry[begin[b] + atomic_add(&filled[b], 1)] = contact;
  }
};

/// Contacts are numbered by (a, b), so ascending contact numbers are ascending ids of the other body.
struct SortLists {
  const std::uint32_t *count, *begin;
  std::uint32_t* entry;
  SIM_HD void operator()(int body) const {
    if (count[body] > 1) sort_segment(entry + begin[body], count[body]);
  }
};

}  // namespace

ContactsByBody::ContactsByBody(Executor& executor)
    : executor_(executor),
      items_(executor, "size of lists by body"),
      count_(executor, "listed contacts per body"),
      filled_(executor, "listed contacts filled"),
      begin_(executor, "starts of lists by body"),
      entry_(executor, "contacts by body") {}

void ContactsByBody::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  bodies_ = bodies;
  contact_capacity_ = contact_capacity;
  const auto n = static_cast<std::size_t>(bodies);
  items_.resize_discarding(2);
  count_.resize_discarding(n);
  filled_.resize_discarding(n);
  begin_.resize_discarding(n);
  entry_.resize_discarding(2 * static_cast<std::size_t>(contact_capacity));
}

void ContactsByBody::list(const char* stage, const Pair* contacts, const std::uint32_t* order,
                          const std::uint32_t* begin, const std::uint32_t* count) {
  const Count listed(count, contact_capacity_);
  executor_.run(stage, 1, BeginLists{count, static_cast<std::uint32_t>(bodies_), items_.data()});
  executor_.run(stage, bodies(), ClearLists{count_.data(), filled_.data()});
  executor_.run(stage, listed, CountEntries{contacts, order, begin, count_.data()});
  executor_.run(stage, bodies(), PlaceLists{count_.data(), items_.data() + 1, begin_.data()});
  executor_.run(stage, listed,
                FillLists{contacts, order, begin, begin_.data(), filled_.data(), entry_.data()});
  executor_.run(stage, bodies(), SortLists{count_.data(), begin_.data(), entry_.data()});
}

}  // namespace collidoscope
