#include "sim_cuda/core/host_backup.h"

#include <cstring>

namespace collidoscope {
namespace {

void copy(ThreadTeam& team, std::byte* to, const std::byte* from, std::size_t bytes) {
  struct Copy {
    std::byte* to;
    const std::byte* from;
  } context{to, from};
  constexpr std::int64_t piece = 1 << 18;
  team.parallel_for(
      static_cast<std::int64_t>(bytes), piece,
      [](void* c, std::int64_t begin, std::int64_t end) {
        const Copy& k = *static_cast<const Copy*>(c);
        std::memcpy(k.to + begin, k.from + begin, static_cast<std::size_t>(end - begin));
      },
      &context);
}

}  // namespace

void HostBackup::save(ThreadTeam& team, const std::function<void(const ArrayVisitor&)>& visit_all) {
  arrays_.clear();
  std::size_t all = 0;
  visit_all([&](void* data, std::size_t bytes) {
    if (bytes == 0) return;
    arrays_.push_back({static_cast<std::byte*>(data), bytes, all});
    all += bytes;
  });
  if (all > capacity_) {
    copy_.reset();
    capacity_ = 0;
    copy_.reset(new std::byte[all]);
    capacity_ = all;
  }
  for (const Array& array : arrays_) copy(team, copy_.get() + array.at, array.place, array.bytes);
}

void HostBackup::restore(ThreadTeam& team) {
  for (const Array& array : arrays_) copy(team, array.place, copy_.get() + array.at, array.bytes);
}

}  // namespace collidoscope
