#include "sim_cuda/core/parallel_for.h"

#include <algorithm>

#if SIM_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#else
#include <atomic>
#include <thread>
#include <vector>
#endif

namespace collidoscope {

#if SIM_TBB

struct ThreadTeam::Impl {
  explicit Impl(int count) : arena(count), threads(count) {}
  tbb::task_arena arena;
  int threads;
};

void ThreadTeam::parallel_for(std::int64_t count, std::int64_t grain,
                              void (*body)(void*, std::int64_t, std::int64_t), void* context) {
  if (count <= grain || impl_->threads == 1) {
    if (count > 0) body(context, 0, count);
    return;
  }
  impl_->arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, static_cast<std::size_t>(grain)),
                      [&](const tbb::blocked_range<std::int64_t>& r) { body(context, r.begin(), r.end()); });
  });
}

void ThreadTeam::sort(KeyedIndex* records, std::int64_t count) {
  impl_->arena.execute([&] { tbb::parallel_sort(records, records + count); });
}

#else

struct ThreadTeam::Impl {
  explicit Impl(int count) : threads(count) {}
  int threads;
};

void ThreadTeam::parallel_for(std::int64_t count, std::int64_t grain,
                              void (*body)(void*, std::int64_t, std::int64_t), void* context) {
  if (count <= grain || impl_->threads == 1) {
    if (count > 0) body(context, 0, count);
    return;
  }
  std::atomic<std::int64_t> next{0};
  auto work = [&] {
    for (;;) {
      const std::int64_t begin = next.fetch_add(grain, std::memory_order_relaxed);
      if (begin >= count) return;
      body(context, begin, std::min(begin + grain, count));
    }
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < impl_->threads; ++t) helpers.emplace_back(work);
  work();
}

void ThreadTeam::sort(KeyedIndex* records, std::int64_t count) { std::sort(records, records + count); }

#endif

ThreadTeam::ThreadTeam(int threads) : impl_(std::make_unique<Impl>(threads)) {}
ThreadTeam::~ThreadTeam() = default;
int ThreadTeam::threads() const { return impl_->threads; }

}  // namespace collidoscope
