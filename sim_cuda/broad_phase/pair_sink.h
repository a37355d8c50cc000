#pragma once
// Output of a broad phase: pairs are appended to one list in any order, and counted per body, in a single
// traversal. pair_list.cpp sorts them, so the order of arrival has no effect.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/executor.h"

namespace collidoscope {

struct FoundPair {
  Pair pair;
  std::uint32_t rank;  ///< number of pairs of pair.a found before
};

struct PairSink {
  FoundPair* found;  ///< `capacity` elements
  std::uint64_t capacity;
  std::uint64_t* total;  ///< number of pairs found, including those beyond the capacity
  std::uint32_t* count;  ///< per body: pairs in which it has the smaller id

  /// Adds an overlapping pair; each pair once, x != y in either order. For queries that may find several
  /// pairs, PairBatch is cheaper, because every add() updates the same counter.
  SIM_HD void add(std::uint32_t x, std::uint32_t y) const { put(atomic_add_aggregated(total, 1), x, y); }

  SIM_HD void put(std::uint64_t place, std::uint32_t x, std::uint32_t y) const {
    const Pair pair = x < y ? Pair{x, y} : Pair{y, x};
    const std::uint32_t rank = atomic_add(&count[pair.a], 1);
    if (place < capacity) found[place] = {pair, rank};
  }
};

/// Buffers the pairs of one query, and passes them to the sink in groups. Call finish() at the end of the
/// query.
class PairBatch {
 public:
  SIM_HD PairBatch(const PairSink& sink, std::uint32_t body) : sink_(sink), body_(body) {}
  SIM_HD void add(std::uint32_t other) {
    if (buffered_ == room) flush(atomic_add(sink_.total, room));
#if defined(__CUDA_ARCH__)
    // Constant indices, here and in flush(), so that a GPU keeps the array in registers.
    for (std::uint32_t k = 0; k < room; ++k)
      if (k == buffered_) other_[k] = other;
#else
    other_[buffered_] = other;
#endif
    ++buffered_;
  }
  /// Counts nothing; VisitCount counts the visited nodes.
  SIM_HD void visit() const {}
  SIM_HD void finish() { flush(atomic_add_aggregated(sink_.total, buffered_)); }

 private:
  SIM_HD void flush(std::uint64_t first) {
#if defined(__CUDA_ARCH__)
    const std::uint32_t end = room;
#else
    const std::uint32_t end = buffered_;
#endif
    for (std::uint32_t k = 0; k < end; ++k)
      if (k < buffered_) sink_.put(first + k, body_, other_[k]);
    buffered_ = 0;
  }

  static constexpr std::uint32_t room = 8;  // most queries find fewer, and update the counter once
  PairSink sink_;                           // a copy, because kernel parameters have no address
  std::uint32_t body_, buffered_ = 0, other_[room] = {};
};

/// Replaces PairSink to count the nodes that a traversal visits.
struct VisitSink {
  std::uint32_t* of_query;  ///< by item of the query's stage; initially 0
  std::uint64_t* shared;    ///< visits shared by several queries; initially 0
};

/// Replaces PairBatch: counts visits, ignores pairs.
class VisitCount {
 public:
  SIM_HD explicit VisitCount(std::uint32_t* visits) : visits_(visits) {}
  SIM_HD void visit() { ++count_; }
  SIM_HD void add(std::uint32_t) const {}
  SIM_HD void finish() const { *visits_ = count_; }

 private:
  std::uint32_t* visits_;
  std::uint32_t count_ = 0;
};

/// Starts the query of `body`, item `item` of its stage, with the output for the sink.
SIM_HD inline PairBatch start_query(const PairSink& sink, int, std::uint32_t body) { return {sink, body}; }
SIM_HD inline VisitCount start_query(const VisitSink& sink, int item, std::uint32_t) {
  return VisitCount(sink.of_query + item);
}

}  // namespace collidoscope
