#include "sim_cuda/run/state_mark.h"

namespace collidoscope {
namespace {

struct Array {
  void* data;
  std::size_t bytes;
};

std::vector<Array> arrays_of(Pipeline& pipeline) {
  std::vector<Array> arrays;
  pipeline.visit_persistent_arrays([&](void* data, std::size_t bytes) { arrays.push_back({data, bytes}); });
  return arrays;
}

}  // namespace

void StateMark::set(Pipeline& pipeline) {
  clear();
  const std::vector<Array> arrays = arrays_of(pipeline);
  std::size_t bytes = 0;
  for (const Array& array : arrays) bytes += array.bytes;
  copy_.resize_discarding(bytes);
  std::byte* to = copy_.data();
  for (const Array& array : arrays) {
    executor_.copy(to, array.data, array.bytes);
    to += array.bytes;
    sizes_.push_back(array.bytes);
  }
}

bool StateMark::rewind(Pipeline& pipeline) {
  const std::vector<Array> arrays = arrays_of(pipeline);
  if (arrays.size() != sizes_.size()) return false;
  const std::byte* from = copy_.data();
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    executor_.copy(arrays[k].data, from, sizes_[k]);
    from += sizes_[k];
  }
  return true;
}

}  // namespace collidoscope
