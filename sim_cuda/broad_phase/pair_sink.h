#pragma once
// Where a broad phase leaves the pairs that it finds: appended to one list in any order and counted per body,
// in a single traversal. pair_list.cpp then puts them in order, so the order of arrival is never seen.

#include <cstdint>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/executor.h"

namespace collidoscope {

struct FoundPair {
  Pair pair;
  std::uint32_t rank;  ///< how many pairs of pair.a were found before it
};

struct PairSink {
  FoundPair* found;  ///< room for `capacity`
  std::uint64_t capacity;
  std::uint64_t* total;  ///< pairs found, those beyond the capacity too: what it takes is always known
  std::uint32_t* count;  ///< per body: pairs in which it is the smaller id

  /// Each overlapping pair once, in either order; x != y. Where one query may find several, PairBatch costs
  /// less: all that add() meet at one counter.
  SIM_HD void add(std::uint32_t x, std::uint32_t y) const { put(atomic_add_aggregated(total, 1), x, y); }

  SIM_HD void put(std::uint64_t place, std::uint32_t x, std::uint32_t y) const {
    const Pair pair = x < y ? Pair{x, y} : Pair{y, x};
    const std::uint32_t rank = atomic_add(&count[pair.a], 1);
    if (place < capacity) found[place] = {pair, rank};
  }
};

/// What one body's query finds, handed to the sink a few at a time. finish() when the query is done.
class PairBatch {
 public:
  SIM_HD PairBatch(const PairSink& sink, std::uint32_t body) : sink_(sink), body_(body) {}
  SIM_HD void add(std::uint32_t other) {
    if (buffered_ == room) flush(atomic_add(sink_.total, room));
    // Constant places, here and in flush(), let a GPU keep them in registers.
    for (std::uint32_t k = 0; k < room; ++k)
      if (k == buffered_) other_[k] = other;
    ++buffered_;
  }
  /// One more node of the hierarchy is read: VisitCount.
  SIM_HD void visit() const {}
  SIM_HD void finish() { flush(atomic_add_aggregated(sink_.total, buffered_)); }

 private:
  SIM_HD void flush(std::uint64_t first) {
    for (std::uint32_t k = 0; k < room; ++k)
      if (k < buffered_) sink_.put(first + k, body_, other_[k]);
    buffered_ = 0;
  }

  static constexpr std::uint32_t room = 8;  // more than most queries find: one visit to the counter for each
  PairSink sink_;                           // a copy: parameters of a kernel have no address
  std::uint32_t body_, buffered_ = 0, other_[room] = {};
};

/// In place of a PairSink: the same traversal counts what it reads.
struct VisitSink {
  std::uint32_t* of_query;  ///< by the item of the query in its stage; starts with zeros
  std::uint64_t* shared;    ///< of no single query; starts at zero
};

/// In place of a PairBatch.
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

/// What the query of `body`, item `item` of its stage, reports to.
SIM_HD inline PairBatch start_query(const PairSink& sink, int, std::uint32_t body) { return {sink, body}; }
SIM_HD inline VisitCount start_query(const VisitSink& sink, int item, std::uint32_t) {
  return VisitCount(sink.of_query + item);
}

}  // namespace collidoscope
