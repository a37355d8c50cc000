#pragma once
// The one seam between CPU stages and a thread library: oneTBB, or std::thread where the thread sanitizer
// must see every synchronisation (Debian's oneTBB is not instrumented).

#include <cstdint>
#include <memory>

namespace collidoscope {

/// A fixed number of CPU threads. Created once per executor.
class ThreadTeam {
 public:
  explicit ThreadTeam(int threads);  ///< >= 1; includes the calling thread
  ~ThreadTeam();
  int threads() const;

  /// Calls body(context, begin, end) on disjoint ranges that cover [0, count), about `grain` long or longer;
  /// returns when all have returned. Must not be nested.
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
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collidoscope
