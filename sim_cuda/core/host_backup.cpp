#include "sim_cuda/core/host_backup.h"

namespace collidoscope {

void HostBackup::save(Executor& executor, const std::function<void(const ArrayVisitor&)>& visit_all) {
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
  for (const Array& array : arrays_) executor.copy(copy_.get() + array.at, array.place, array.bytes);
}

void HostBackup::restore(Executor& executor) {
  for (const Array& array : arrays_) executor.copy(array.place, copy_.get() + array.at, array.bytes);
}

}  // namespace collidoscope
