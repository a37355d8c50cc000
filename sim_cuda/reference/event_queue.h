#pragma once
// Priority queue of predicted events, earliest first (binary heap). Owned by HardSpheres.
// Events are not removed when they become invalid. Each event stores the collision counts of its bodies at
// prediction time; a different count marks it as stale.

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

namespace collidoscope {

struct Event {
  double time;                ///< s
  std::uint32_t body, other;  ///< ids; HardSpheres defines the meaning of `other`: a body, a plane or a cell
                              ///< edge
  std::uint32_t collision_count, other_collision_count;  ///< collision counts at prediction time

  /// Reverse order for std heaps: by time, then by ids. Independent of the order of insertion.
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
  /// Removes all events for which is_stale(event) is true.
  template <class IsStale>
  void drop_if(const IsStale& is_stale) {
    std::erase_if(heap_, is_stale);
    std::make_heap(heap_.begin(), heap_.end());
  }

 private:
  std::vector<Event> heap_;  // heap with the earliest event first
};

}  // namespace collidoscope
