#include "sim_cuda/core/parallel_for.h"

#include <algorithm>
#include <atomic>
#include <ctime>

#include "sim_cuda/core/cancellation.h"

#if SIM_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <map>
#include <mutex>
#include <vector>
#else
#include <thread>
#include <vector>
#endif

namespace collidoscope {

#if SIM_TBB

namespace {

/// Pool of unused arenas, by number of threads. Reason: oneTBB (2021.8) leaks 4 KiB of an arena that is
/// released while workers are in it, and searches all leaked arenas whenever one is created.
class SpareArenas {
 public:
  using Arena = std::unique_ptr<tbb::task_arena>;
  /// Never destroyed, because teams may outlive static objects.
  static SpareArenas& all() {
    static SpareArenas& spare = *new SpareArenas;
    return spare;
  }
  Arena acquire(int threads) {
    const std::lock_guard lock(mutex_);
    std::vector<Arena>& spare = spare_[threads];
    if (!spare.empty()) {
      Arena arena = std::move(spare.back());
      spare.pop_back();
      return arena;
    }
    Arena arena = std::make_unique<tbb::task_arena>(threads);
    // Initialise now: an arena whose later initialisation runs out of memory is unusable.
    arena->initialize();
    return arena;
  }
  void release(int threads, Arena arena) noexcept {
    const std::lock_guard lock(mutex_);
    try {
      spare_.at(threads).push_back(std::move(arena));
    } catch (const std::bad_alloc&) {  // the arena is destroyed instead, and may leak as above
    }
  }

 private:
  std::mutex mutex_;
  std::map<int, std::vector<Arena>> spare_;
};

}  // namespace

struct ThreadTeam::Impl {
  explicit Impl(int count) : threads(count), arena(SpareArenas::all().acquire(count)) {}
  ~Impl() { SpareArenas::all().release(threads, std::move(arena)); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  int threads;
  SpareArenas::Arena arena;
};

template <class Body>
void ThreadTeam::share(std::int64_t count, std::int64_t grain, const Body& body) {
  impl_->arena->execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, static_cast<std::size_t>(grain)),
                      [&](const tbb::blocked_range<std::int64_t>& r) { body(r.begin(), r.end()); });
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

template <class Body>
void ThreadTeam::share(std::int64_t count, std::int64_t grain, const Body& body) {
  std::atomic<std::int64_t> next{0};
  auto work = [&] {
    for (;;) {
      const std::int64_t begin = next.fetch_add(grain, std::memory_order_relaxed);
      if (begin >= count) return;
      body(begin, std::min(begin + grain, count));
    }
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < impl_->threads; ++t) helpers.emplace_back(work);
  work();
}

void ThreadTeam::sort(KeyedIndex* records, std::int64_t count) { std::sort(records, records + count); }

#endif

namespace {

/// ns; a read takes a few ns. The resolution is a few ms.
std::int64_t coarse_clock() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

/// Number of items between two cancellation checks. Starts small, because items may be slow. Then grows up to
/// `grain`, as long as a chunk takes less than `longest`.
class Stride {
 public:
  explicit Stride(std::int64_t grain) : grain_(grain), items_(std::min<std::int64_t>(grain, 4)) {}
  std::int64_t items() const { return items_.load(std::memory_order_relaxed); }
  void record(std::int64_t items, std::int64_t nanoseconds) {
    constexpr std::int64_t longest = 20'000'000;
    const std::int64_t next = nanoseconds < longest / 2 ? std::min(2 * items, grain_)
                              : nanoseconds > longest   ? items / 2
                                                        : items;
    if (next != items) items_.store(std::max<std::int64_t>(next, 1), std::memory_order_relaxed);
  }

 private:
  const std::int64_t grain_;
  std::atomic<std::int64_t> items_;  // shared by all threads
};

}  // namespace

void ThreadTeam::parallel_for(std::int64_t count, std::int64_t grain,
                              void (*body)(void*, std::int64_t, std::int64_t), void* context) {
  if (count <= 0) return;
  throw_if_cancelled();
  const bool alone = count <= grain || impl_->threads == 1;
  if (count <= grain || (alone && cancellation_ == nullptr)) {
    body(context, 0, count);
  } else if (cancellation_ == nullptr) {
    share(count, grain, [&](std::int64_t begin, std::int64_t end) { body(context, begin, end); });
  } else {
    Stride stride(grain);
    const auto polled = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t before = coarse_clock(); begin < end && !poll();) {
        const std::int64_t items = std::min(stride.items(), end - begin);
        body(context, begin, begin + items);
        begin += items;
        const std::int64_t now = coarse_clock();
        stride.record(items, now - before);
        before = now;
      }
    };
    alone ? polled(0, count) : share(count, grain, polled);
  }
  if (stopped()) throw_cancelled();
}

bool ThreadTeam::poll() {
  if (!cancellation_->poll()) return false;
  stopped_.store(true, std::memory_order_relaxed);
  return true;
}

void ThreadTeam::throw_cancelled() { throw Cancelled(); }

ThreadTeam::ThreadTeam(int threads) : impl_(std::make_unique<Impl>(threads)) {}
ThreadTeam::~ThreadTeam() = default;
int ThreadTeam::threads() const { return impl_->threads; }

}  // namespace collidoscope
