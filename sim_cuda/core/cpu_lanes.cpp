#include "sim_cuda/core/cpu_lanes.h"

#include <algorithm>

namespace collidoscope {

namespace {

struct ChunkedItems {
  ItemLoop loop;
  const void* stage;
};

struct LaneItems {
  ItemLoop loop;
  const void* stage;
  std::int64_t items, lanes;
  LaneOrder order;
  ThreadTeam& team;
  std::int64_t chunk;

  void run(std::int64_t lane) const {
    if (order == LaneOrder::strided) return chunks(lane, lanes, (items - lane + lanes - 1) / lanes);
    const std::int64_t first = items * lane / lanes, own = items * (lane + 1) / lanes - first;
    if (order == LaneOrder::contiguous) return chunks(first, 1, own);
    const std::int64_t a = shuffle_multiplier(items), b = items / 3;
    for (std::int64_t k = 0; k < own && (k % chunk != 0 || !team.is_cancelled()); ++k)
      loop(stage, (a * (first + k) + b) % items, 1, 1);
  }

 private:
  void chunks(std::int64_t first, std::int64_t stride, std::int64_t own) const {
    for (std::int64_t k = 0; k < own && !team.is_cancelled(); k += chunk)
      loop(stage, first + k * stride, stride, std::min(chunk, own - k));
  }
  /// A multiplier a for which item -> (a * item + b) mod n is a permutation: a prime that does not divide n.
  static std::int64_t shuffle_multiplier(std::int64_t n) {
    for (const std::int64_t prime : {1000003LL, 998244353LL, 1000000007LL})
      if (n % prime != 0) return prime % n == 0 ? 1 : prime % n;
    return 1;
  }
};

}  // namespace

void run_in_chunks(ThreadTeam& team, std::int64_t count, std::int64_t chunk, ItemLoop loop,
                   const void* stage) {
  ChunkedItems items{loop, stage};
  team.parallel_for(
      count, chunk,
      [](void* context, std::int64_t begin, std::int64_t end) {
        const auto& all = *static_cast<const ChunkedItems*>(context);
        all.loop(all.stage, begin, 1, end - begin);
      },
      &items);
}

void run_in_lanes(ThreadTeam& team, std::int64_t count, std::int64_t lanes, LaneOrder order,
                  std::int64_t chunk, ItemLoop loop, const void* stage) {
  LaneItems items{loop, stage, count, lanes, order, team, chunk};
  team.parallel_for(
      lanes, 1,
      [](void* context, std::int64_t begin, std::int64_t end) {
        for (std::int64_t lane = begin; lane < end; ++lane) static_cast<const LaneItems*>(context)->run(lane);
      },
      &items);
}

}  // namespace collidoscope
