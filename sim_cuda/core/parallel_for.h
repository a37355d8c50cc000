#pragma once
// Interface between CPU stages and the thread library: oneTBB, or std::thread for the thread sanitizer, which
// must see all synchronisation (Debian's oneTBB is not instrumented).

#include <atomic>
#include <cstdint>
#include <memory>

namespace collidoscope {

class Cancellation;

/// A team with a fixed number of CPU threads. Created once per executor.
class ThreadTeam {
 public:
  explicit ThreadTeam(int threads);  ///< >= 1; includes the calling thread
  ~ThreadTeam();
  int threads() const;

  /// The cancellation that parallel_for() checks between chunks; null: none. Not owned.
  void set_cancellation(Cancellation* cancellation) { cancellation_ = cancellation; }
  /// Whether work was cancelled since the last resume(). If so, its results may be incomplete.
  bool stopped() const { return stopped_.load(std::memory_order_relaxed); }
  void resume() { stopped_.store(false, std::memory_order_relaxed); }
  /// Throws Cancelled if a cancellation was requested. Call it on the thread that calls parallel_for().
  void throw_if_cancelled() {
    if (is_cancelled()) throw_cancelled();
  }
  /// For long-running bodies: whether to return immediately. parallel_for() then throws Cancelled.
  bool is_cancelled() { return cancellation_ != nullptr && poll(); }

  /// Calls body(context, begin, end) on disjoint ranges that cover [0, count), about `grain` long. Ranges may
  /// be longer without a cancellation. Returns after all calls have returned. Must not be nested. Throws
  /// Cancelled if a cancellation skipped some ranges; completed ranges keep their effect.
  void parallel_for(std::int64_t count, std::int64_t grain,
                    void (*body)(void* context, std::int64_t begin, std::int64_t end), void* context);

  /// Sorts `count` records in place by operator<, which must be a total order.
  struct KeyedIndex {
    std::uint64_t key;
    std::uint32_t index;
    friend bool operator<(const KeyedIndex& a, const KeyedIndex& b) {
      return a.key < b.key || (a.key == b.key && a.index < b.index);
    }
  };
  void sort(KeyedIndex* records, std::int64_t count);

 private:
  bool poll();
  [[noreturn]] static void throw_cancelled();
  template <class Body>
  void share(std::int64_t count, std::int64_t grain, const Body& body);

  struct Impl;
  std::unique_ptr<Impl> impl_;
  Cancellation* cancellation_ = nullptr;
  std::atomic<bool> stopped_ = false;
};

}  // namespace collidoscope
