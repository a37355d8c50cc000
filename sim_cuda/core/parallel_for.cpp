#include "sim_cuda/core/parallel_for.h"

#include <algorithm>

#if SIM_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <map>
#include <mutex>
#include <vector>
#else
#include <atomic>
#include <thread>
#include <vector>
#endif

namespace collidoscope {

#if SIM_TBB

namespace {

/// Arenas that no team uses now, by their threads. oneTBB (2021.8) keeps 4 KiB of one whose workers were
/// still there when it was given up, and looks through all of these whenever another is made.
class SpareArenas {
 public:
  using Arena = std::unique_ptr<tbb::task_arena>;
  /// Never destroyed: teams may outlive whatever is destroyed at the end of the program.
  static SpareArenas& all() {
    static SpareArenas& spare = *new SpareArenas;
    return spare;
  }
  Arena take(int threads) {
    const std::lock_guard lock(mutex_);
    std::vector<Arena>& spare = spare_[threads];
    if (!spare.empty()) {
      Arena arena = std::move(spare.back());
      spare.pop_back();
      return arena;
    }
    Arena arena = std::make_unique<tbb::task_arena>(threads);
    arena->initialize();  // or it is none that may be used again, where memory is refused to it later
    return arena;
  }
  void give_back(int threads, Arena arena) noexcept {
    const std::lock_guard lock(mutex_);
    try {
      spare_.at(threads).push_back(std::move(arena));
    } catch (const std::bad_alloc&) {  // then it is one that oneTBB may keep
    }
  }

 private:
  std::mutex mutex_;
  std::map<int, std::vector<Arena>> spare_;
};

}  // namespace

struct ThreadTeam::Impl {
  explicit Impl(int count) : threads(count), arena(SpareArenas::all().take(count)) {}
  ~Impl() { SpareArenas::all().give_back(threads, std::move(arena)); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  int threads;
  SpareArenas::Arena arena;
};

void ThreadTeam::parallel_for(std::int64_t count, std::int64_t grain,
                              void (*body)(void*, std::int64_t, std::int64_t), void* context) {
  if (count <= grain || impl_->threads == 1) {
    if (count > 0) body(context, 0, count);
    return;
  }
  impl_->arena->execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, static_cast<std::size_t>(grain)),
                      [&](const tbb::blocked_range<std::int64_t>& r) { body(context, r.begin(), r.end()); });
  });
}

void ThreadTeam::sort(KeyedIndex* records, std::int64_t count) {
  impl_->arena->execute([&] { tbb::parallel_sort(records, records + count); });
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
