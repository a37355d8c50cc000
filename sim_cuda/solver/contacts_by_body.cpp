#include "sim_cuda/solver/contacts_by_body.h"

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/block.h"
#include "sim_cuda/core/segment_sort.h"

namespace collidoscope {

namespace {

struct ClearFilled {
  std::uint32_t* filled;
  SIM_HD void operator()(int body) const { filled[body] = 0; }
};

struct FillLists {
  ContactSet set;
  const std::uint32_t* begin;
  std::uint32_t *filled, *entry;
  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = set.number(item);
    const auto [a, b] = set.contacts[contact];
    entry[begin[a] + atomic_add(&filled[a], 1)] = 2 * contact;
    entry[begin[b] + atomic_add(&filled[b], 1)] = 2 * contact + 1;
  }
};

/// Contact numbers increase with (a, b). So increasing contact numbers are increasing ids of the other
/// body.
struct SortLists {
  DegreeView degrees;
  const std::uint32_t* place;
  std::uint32_t* entry;
  SIM_HD void operator()(int body) const {
    const std::uint32_t count = degrees.count[body];
    if (count == 0) return;
    std::uint32_t* segment = entry + degrees.begin[body];
    if (count > 1) sort_segment(segment, count);
    if (place == nullptr) return;
    for (std::uint32_t k = 0; k < count; ++k) segment[k] = to_place(segment[k]);
  }
  SIM_HD std::uint32_t to_place(std::uint32_t end) const { return 2 * place[end / 2] + end % 2; }

  SIM_HD bool is_large(int body) const { return degrees.count[body] > large_list_size; }
#if defined(__CUDACC__)
  __device__ void process_by_block(int body) const {
    const std::uint32_t count = degrees.count[body];
    std::uint32_t* segment = entry + degrees.begin[body];
    sort_segment_by_block(segment, count);
    if (place == nullptr) return;
    for (std::uint32_t k = threadIdx.x; k < count; k += blockDim.x) segment[k] = to_place(segment[k]);
  }
#endif
};

}  // namespace

ContactsByBody::ContactsByBody(Executor& executor)
    : executor_(executor),
      filled_(executor, "contact list fill counts"),
      entry_(executor, "contacts by body") {}

void ContactsByBody::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  filled_.resize_discarding(static_cast<std::size_t>(bodies));
  entry_.resize_discarding(2 * static_cast<std::size_t>(contact_capacity));
}

void ContactsByBody::list(const char* stage, const ContactSet& set, const ContactDegrees& degrees,
                          const std::uint32_t* place) {
  executor_.run(stage, degrees.bodies(), ClearFilled{filled_.data()});
  executor_.run(stage, ItemCount(set.count, contact_capacity_),
                FillLists{set, degrees.view().begin, filled_.data(), entry_.data()});
  executor_.run(stage, degrees.bodies(), SortLists{degrees.view(), place, entry_.data()});
}

}  // namespace collidoscope
