#pragma once
// The one seam between CPU stages and a thread library: oneTBB, or std::thread where the thread sanitizer
// must see every synchronisation (Debian's oneTBB is not instrumented).

#include <atomic>
#include <cstdint>
#include <memory>

namespace collidoscope {

class Cancellation;

/// A fixed number of CPU threads. Created once per executor.
class ThreadTeam {
 public:
  explicit ThreadTeam(int threads);  ///< >= 1; includes the calling thread
  ~ThreadTeam();
  int threads() const;

  /// What parallel_for() looks at between chunks; null: nothing. Not owned.
  void set_cancellation(Cancellation* cancellation) { cancellation_ = cancellation; }
  /// Whether work was cancelled since the last resume(): its results may be incomplete.
  bool stopped() const { return stopped_.load(std::memory_order_relaxed); }
  void resume() { stopped_.store(false, std::memory_order_relaxed); }
  /// Throws Cancelled if that was requested. By the thread that calls parallel_for().
  void throw_if_cancelled() {
    if (is_cancelled()) throw_cancelled();
  }
  /// Within a body that takes long: whether to return at once. parallel_for() then throws.
  bool is_cancelled() { return cancellation_ != nullptr && look(); }

  /// Calls body(context, begin, end) on disjoint ranges that cover [0, count), about `grain` long; without a
  /// cancellation also longer. Returns when all have returned. Must not be nested. Throws Cancelled where
  /// that was requested and some ranges were not called; a body that was called as a whole has its effect.
  void parallel_for(std::int64_t count, std::int64_t grain,
                    void (*body)(void* context, std::int64_t begin, std::int64_t end), void* context);

  /// Sorts `count` records in place by operator<, which must order any two different records.
  struct KeyedIndex {
    std::uint64_t key;
    std::uint32_t index;
    friend bool operator<(const KeyedIndex& a, const KeyedIndex& b) {
      return a.key < b.key || (a.key == b.key && a.index < b.index);
    }
  };
  void sort(KeyedIndex* records, std::int64_t count);

 private:
  bool look();
  [[noreturn]] static void throw_cancelled();
  template <class Body>
  void share(std::int64_t count, std::int64_t grain, const Body& body);

  struct Impl;
  std::unique_ptr<Impl> impl_;
  Cancellation* cancellation_ = nullptr;
  std::atomic<bool> stopped_ = false;
};

}  // namespace collidoscope
