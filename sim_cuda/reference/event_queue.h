#pragma once
// Events to come, the next one first: a binary heap. Events are never looked for to be taken out: each
// carries how often its bodies had collided when it was foreseen, and whoever takes it sees that it no longer
// holds. Owned by HardSpheres.

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

namespace collidoscope {

struct Event {
  double time;                                           ///< s
  std::uint32_t body, other;                             ///< what `other` stands for is the owner's matter
  std::uint32_t collision_count, other_collision_count;  ///< collisions that each had had

  /// Later, or as late and of larger ids: the order is that of time and ids, however events came in.
  friend bool operator<(const Event& a, const Event& b) {
    return std::tie(b.time, b.body, b.other) < std::tie(a.time, a.body, a.other);
  }
};

class EventQueue {
 public:
  bool empty() const { return heap_.empty(); }
  std::size_t size() const { return heap_.size(); }
  const Event& next() const { return heap_.front(); }

  void add(const Event& event) {
    heap_.push_back(event);
    std::push_heap(heap_.begin(), heap_.end());
  }
  void drop_next() {
    std::pop_heap(heap_.begin(), heap_.end());
    heap_.pop_back();
  }
  /// Drops those of which is_stale(event) holds, wherever they are.
  template <class IsStale>
  void drop_if(const IsStale& is_stale) {
    std::erase_if(heap_, is_stale);
    std::make_heap(heap_.begin(), heap_.end());
  }

 private:
  std::vector<Event> heap_;  // a heap by <, which puts the earliest first
};

}  // namespace collidoscope
