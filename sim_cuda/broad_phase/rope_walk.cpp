#include "sim_cuda/broad_phase/rope_walk.h"

#include "sim_cuda/core/vector_load.h"

namespace collidoscope {

namespace {

/// One walk per query.
template <class Sink>
struct WalkRopes {
  const RopedNode* nodes;
  std::uint32_t n;
  Sink sink;
  SIM_HD void operator()(int leaf) const {
    const auto& query = load_readonly(&nodes[leaf]);
    auto batch = start_query(sink, leaf, query.child);
    for (std::uint32_t at = query.rope; at != no_rope;) {
      const auto& node = load_readonly(&nodes[at]);
      batch.visit();
      const bool hit = overlap(query, node), is_leaf = at < n;
      if (hit && is_leaf) batch.add(node.child);
      at = hit && !is_leaf ? node.child : node.rope;
    }
    batch.finish();
  }
};

/// CPU version, for trees whose leaves are numbered from left to right. One walk serves `lanes` adjacent
/// leaves: it descends into nodes that overlap the box of all of them, and tests each leaf that it meets
/// against each of them. In a falling pile of 20,000 bodies this takes 0.35 times as long as one walk per
/// leaf.
struct WalkInGroups {
  static constexpr std::uint32_t lanes = 16;
  const RopedNode* nodes;
  std::uint32_t n;
  PairSink sink;

  static std::int64_t groups(std::uint32_t n) { return (std::int64_t{n} + lanes - 1) / lanes; }
  std::int64_t items_per_chunk() const { return usual_chunk / lanes; }

  /// Pairs of a group, buffered for the sink.
  struct Found {
    static constexpr std::uint32_t room = 4 * lanes;
    Pair pairs[room];
    std::uint32_t count = 0;
    SIM_HD void flush(const PairSink& sink) {
      const std::uint64_t place = atomic_add(sink.total, std::uint64_t{count});
      for (std::uint32_t k = 0; k < count; ++k) sink.put(place + k, pairs[k].a, pairs[k].b);
      count = 0;
    }
  };

  /// The leaves of a group.
  struct Group {
    float min[3][lanes], max[3][lanes];
    std::uint32_t body[lanes];
    RopedNode all;  ///< with the box of all of them

    /// Tests the first `leaves` leaves. All lanes are compared, so that SIMD instructions are used.
    SIM_HD void test(const RopedNode& node, std::uint32_t leaves, Found& found, const PairSink& sink) const {
      std::uint32_t hits[lanes];
      for (std::uint32_t k = 0; k < lanes; ++k)
        hits[k] = static_cast<std::uint32_t>((min[0][k] <= node.max[0]) & (node.min[0] <= max[0][k]) &
                                             (min[1][k] <= node.max[1]) & (node.min[1] <= max[1][k]) &
                                             (min[2][k] <= node.max[2]) & (node.min[2] <= max[2][k]));
      if (found.count + lanes > Found::room) found.flush(sink);
      for (std::uint32_t k = 0; k < leaves; ++k) {
        found.pairs[found.count] = {body[k], node.child};
        found.count += hits[k];
      }
    }
  };

  SIM_HD void operator()(int item) const {
    const std::uint32_t first = static_cast<std::uint32_t>(item) * lanes, leaves = min_of(lanes, n - first);
    Group group;
    group.all = nodes[first];
    for (std::uint32_t k = 0; k < lanes; ++k) {
      const RopedNode& leaf = nodes[first + min_of(k, leaves - 1)];
      group.body[k] = leaf.child;
      for (int axis = 0; axis < 3; ++axis) {
        group.min[axis][k] = leaf.min[axis];
        group.max[axis][k] = leaf.max[axis];
        group.all.min[axis] = min_of(group.all.min[axis], leaf.min[axis]);
        group.all.max[axis] = max_of(group.all.max[axis], leaf.max[axis]);
      }
    }
    Found found;
    for (std::uint32_t k = 1; k < leaves; ++k) group.test(nodes[first + k], k, found, sink);
    for (std::uint32_t at = nodes[first + leaves - 1].rope; at != no_rope;) {
      const RopedNode& node = nodes[at];
      const bool hit = overlap(group.all, node), is_leaf = at < n;
      if (hit && is_leaf) group.test(node, leaves, found, sink);
      at = hit && !is_leaf ? node.child : node.rope;
    }
    found.flush(sink);
  }
};

#if defined(__CUDACC__)

// Warp-cooperative traversal. A walk is a range of the tree, from a node to a rope. After descending into a
// node, the part from the node's rope on can be given to another lane. Each warp has its own range of
// queries. An idle lane takes the next query of that range. If none is left, it takes part of another lane's
// walk, so the longest query does not delay the warp.
//
// This is faster if there are fewer queries than the GPU can run concurrently, where the longest query
// determines the time. With more queries, other warps hide that latency. Then one thread per query is faster,
// because adjacent queries that start together read the same nodes.

constexpr std::uint32_t warp_size = 32;
constexpr std::int64_t lanes_per_query = 4;      // more lanes do not pay, because splitting costs time
constexpr std::uint32_t idle_lanes_to_wait = 4;  // lanes that must be idle before work is redistributed
// Number of queries at which both variants are equally fast on an H200, which runs 8,448 warps concurrently.
constexpr std::uint32_t max_shared = 200'000;

/// The rest of a walk.
struct Walk {
  std::uint32_t leaf, at, end;  ///< the query's leaf; the next node; done if at == end
};

/// Shared memory of one warp.
struct WarpSpace {
  uint2 found[2 * warp_size];  ///< pairs buffered for the sink
  Walk rest[warp_size];        ///< walks offered to idle lanes
};

std::size_t warp_space(int threads) {
  return sizeof(WarpSpace) * ((static_cast<std::size_t>(threads) + warp_size - 1) / warp_size);
}

__global__ void __launch_bounds__(1024)
    walk_ropes_by_warp(const RopedNode* nodes, std::uint32_t n, PairSink sink) {
  extern __shared__ WarpSpace spaces[];
  const std::uint32_t warp = threadIdx.x / warp_size, lane = threadIdx.x % warp_size;
  const std::uint32_t lanes = min(warp_size, blockDim.x - warp * warp_size);
  const std::uint32_t all = lanes == warp_size ? ~0u : (1u << lanes) - 1, below = (1u << lane) - 1;
  WarpSpace& space = spaces[warp];
  const auto count = [](std::uint32_t mask) { return static_cast<std::uint32_t>(__popc(mask)); };

  const std::uint32_t warps = (blockDim.x + warp_size - 1) / warp_size;
  const std::uint64_t team = std::uint64_t{blockIdx.x} * warps + warp;
  const std::uint64_t teams = std::uint64_t{gridDim.x} * warps;
  auto next = static_cast<std::uint32_t>(n * team / teams);
  const auto last = static_cast<std::uint32_t>(n * (team + 1) / teams);

  Walk walk{0, no_rope, no_rope};
  std::uint32_t rope = no_rope;  // where this lane's walk can be split; `walk.end`: it cannot
  RopedNode query{};
  std::uint32_t buffered = 0;
  const auto flush = [&](std::uint32_t pairs) {
    std::uint64_t place = 0;
    if (lane == 0) place = atomic_add(sink.total, std::uint64_t{pairs});
    place = __shfl_sync(all, place, 0);
    buffered -= pairs;
    if (lane < pairs) sink.put(place + lane, space.found[buffered + lane].x, space.found[buffered + lane].y);
    __syncwarp(all);
  };

  for (;;) {
    const bool idle = walk.at == walk.end;
    const std::uint32_t idle_lanes = __ballot_sync(all, idle);
    if (idle_lanes == all && next == last) break;
    if (idle_lanes == all || count(idle_lanes) >= idle_lanes_to_wait) {
      const std::uint32_t rank = count(idle_lanes & below);
      if (next < last) {
        if (idle && rank < last - next) {
          walk = {next + rank, no_rope, no_rope};
          query = load_readonly(&nodes[walk.leaf]);
          walk.at = query.rope;
          rope = no_rope;
        }
        next += min(count(idle_lanes), last - next);
      } else {
        const bool has_more = walk.at != walk.end && rope != walk.end;
        const std::uint32_t donors = __ballot_sync(all, has_more);
        const std::uint32_t number = count(donors & below);
        if (has_more && number < count(idle_lanes)) {
          space.rest[number] = {walk.leaf, rope, walk.end};
          walk.end = rope;
        }
        __syncwarp(all);
        if (idle && rank < count(donors)) {
          walk = space.rest[rank];
          rope = walk.end;
          query = load_readonly(&nodes[walk.leaf]);
        }
        __syncwarp(all);
      }
    }

    bool found = false;
    std::uint32_t other = 0;
    if (walk.at != walk.end) {
      const RopedNode node = load_readonly(&nodes[walk.at]);
      const bool hit = overlap(query, node), is_leaf = walk.at < n;
      found = hit && is_leaf;
      other = node.child;
      const bool down = hit && !is_leaf;
      if (down) rope = node.rope;
      walk.at = down ? node.child : node.rope;
      if (walk.at == rope) rope = walk.end;  // the part before the split is done
    }
    const std::uint32_t found_lanes = __ballot_sync(all, found);
    if (found_lanes == 0) continue;
    if (found) space.found[buffered + count(found_lanes & below)] = {query.child, other};
    buffered += count(found_lanes);
    __syncwarp(all);
    if (buffered >= lanes) flush(lanes);
  }
  if (buffered > 0) flush(buffered);
}

#endif

}  // namespace

void find_pairs_by_ropes(Executor& executor, const RopedNode* nodes, std::uint32_t n, LeafOrder order,
                         const PairSink& sink) {
#if defined(__CUDACC__)
  if (executor.on_device() && n <= max_shared)
    return executor.run_kernel("pairs", {lanes_per_query * n, true, warp_space}, walk_ropes_by_warp, nodes, n,
                               sink);
#endif
  if (!executor.on_device() && order == LeafOrder::left_to_right)
    return executor.run("pairs", WalkInGroups::groups(n), WalkInGroups{nodes, n, sink});
  executor.run("pairs", n, WalkRopes<PairSink>{nodes, n, sink});
}

void count_visits_by_ropes(Executor& executor, const RopedNode* nodes, std::uint32_t n,
                           const VisitSink& sink) {
  executor.run("quality", n, WalkRopes<VisitSink>{nodes, n, sink});
}

}  // namespace collidoscope
