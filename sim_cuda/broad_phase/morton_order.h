#pragma once
// Bodies in the order of their Morton keys: where every tree over the z-order curve begins. Owns the keys;
// belongs to a broad phase.
//
// Up to 2^21 bodies with 30-bit keys it is a counting sort: as many cells as bodies, one counter each, and
// within a cell, which mostly holds one or two, every body finds its own place. That is four launches in
// place of a radix sort's eleven. Beyond, and for 63-bit keys, the library sorts; RunOptions::sort may say
// otherwise.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/broad_phase/morton.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/radix_sort.h"
#include "sim_cuda/core/scan.h"
#include "sim_cuda/core/sort.h"

namespace collidoscope {

template <class Key>
struct MakeKeys {
  const Aabb* boxes;
  const Aabb* extent;
  int dropped_bits;
  Key* keys;
  std::uint32_t* ids;
  SIM_HD void operator()(int body) const {
    keys[body] = morton_key<Key>(boxes[body], *extent) >> dropped_bits;
    ids[body] = static_cast<std::uint32_t>(body);
  }
};

template <class Key>
struct CountCells {
  const Aabb* boxes;
  const Aabb* extent;
  int cell_shift;
  Key* keys;
  std::uint32_t *count, *rank;
  SIM_HD void operator()(int body) const {
    const Key key = morton_key<Key>(boxes[body], *extent);
    keys[body] = key;
    rank[body] = atomic_add(&count[key >> cell_shift], 1);
  }
};

template <class Key>
struct ScatterToCells {
  const Key* keys;
  int cell_shift;
  const std::uint32_t *begin, *rank;
  std::uint32_t* arrived;
  SIM_HD void operator()(int body) const {
    arrived[begin[keys[body] >> cell_shift] + rank[body]] = static_cast<std::uint32_t>(body);
  }
};

/// A cell's bodies, which stand in order of arrival, by (key, id). In a crowded cell they stay as they are,
/// and their keys are that of the cell: the tree is worse there and depends on the arrival, the pairs do not.
template <class Key, class Emit>
struct SettleCells {
  static constexpr std::uint32_t crowded = 128;
  const Key* keys;
  int cell_shift;
  const std::uint32_t *begin, *arrived;
  Key* sorted_keys;
  Emit emit;
  SIM_HD void operator()(int k) const {
    const std::uint32_t body = arrived[k];
    Key key = keys[body];
    const Key cell = key >> cell_shift;
    const std::uint32_t first = begin[cell], last = begin[cell + 1];
    std::uint32_t place = first;
    if (last - first > crowded) {
      place = static_cast<std::uint32_t>(k);
      key = cell << cell_shift;
    } else {
      for (std::uint32_t j = first; j < last; ++j) {
        const std::uint32_t other = arrived[j];
        const Key its = keys[other];
        place += its < key || (its == key && other < body);
      }
    }
    sorted_keys[place] = key;
    emit(place, body);
  }
};

template <class Emit>
struct EmitInOrder {
  const std::uint32_t* order;
  Emit emit;
  SIM_HD void operator()(int place) const { emit(static_cast<std::uint32_t>(place), order[place]); }
};

struct NoteBody {
  std::uint32_t* body_at;
  SIM_HD void operator()(std::uint32_t place, std::uint32_t body) const { body_at[place] = body; }
};

template <class Key>
class MortonOrder {
 public:
  explicit MortonOrder(Executor& executor)
      : executor_(executor),
        keys_(executor, "Morton keys"),
        sorted_keys_(executor, "sorted Morton keys"),
        ids_(executor, "ids to sort"),
        order_(executor, "ids in Morton order"),
        count_(executor, "bodies per cell"),
        begin_(executor, "cell starts"),
        temporary_(executor, "sort workspace") {}

  void reserve(std::int64_t bodies) {
    bodies_ = bodies;
    const auto n = static_cast<std::size_t>(bodies);
    for (Buffer<Key>* keys : {&keys_, &sorted_keys_}) keys->resize_discarding(n);
    for (Buffer<std::uint32_t>* ids : {&ids_, &order_}) ids->resize_discarding(n);
    cell_bits_ = 0;
    const SortMethod method = executor_.options().sort;
    if (method == SortMethod::automatic && sizeof(Key) == 4 && bodies <= most_cells)
      for (cell_bits_ = 6; (std::int64_t{1} << cell_bits_) < bodies;) ++cell_bits_;
    // More bits than cells that a body can call its own only cost passes of the sort.
    sorted_bits_ = sizeof(Key) == 8 ? 63 : bodies <= 1 << 24 ? 24 : 30;
    const std::size_t cells = cell_bits_ > 0 ? (std::size_t{1} << cell_bits_) + 1 : 0;
    count_.resize_discarding(cells);
    begin_.resize_discarding(cells);
    temporary_.resize_discarding(
        cells > 0                     ? scan_temporary_bytes(executor_, static_cast<std::int64_t>(cells) - 1)
        : method == SortMethod::radix ? radix_sort_temporary_bytes(bodies)
                                      : sort_temporary_bytes<Key>(executor_, bodies, sorted_bits_));
  }

#if !SIM_CUDA || defined(__CUDACC__)
  /// Calls emit(place, body) once for each place 0 .. bodies - 1, in the stage "sort". `extent`: morton.h.
  template <class Emit>
  void sort(const Aabb* boxes, const Aabb* extent, const Emit& emit) {
    sort(boxes, extent, emit, bodies_);
  }
  /// For those who read bodies() afterwards.
  void sort(const Aabb* boxes, const Aabb* extent) { sort(boxes, extent, NoteBody{bodies_by_place()}); }
  /// If `items` is all bodies. If it is 0, nothing is emitted, and keys() stay those of the last sort.
  template <class Emit>
  void sort(const Aabb* boxes, const Aabb* extent, const Emit& emit, const Count& items) {
    if (cell_bits_ == 0) {
      const bool in_place = executor_.options().sort == SortMethod::radix;
      Key* const keys = in_place ? sorted_keys_.data() : keys_.data();
      std::uint32_t* const ids = in_place ? order_.data() : ids_.data();
      executor_.run("keys", items, MakeKeys<Key>{boxes, extent, key_bits - sorted_bits_, keys, ids});
      if (in_place)
        radix_sort(executor_, "sort", bodies_, sorted_bits_, keys, ids, keys_.data(), ids_.data(),
                   temporary_.data());
      else
        sort_by_key(executor_, "sort", bodies_, sorted_bits_, keys, sorted_keys_.data(), ids, order_.data(),
                    temporary_.data(), temporary_.bytes());
      if constexpr (!std::is_same_v<Emit, NoteBody>)  // that is what the sort has done
        executor_.run("sort", items, EmitInOrder<Emit>{order_.data(), emit});
      return;
    }
    const int shift = key_bits - cell_bits_;
    executor_.begin_stage("keys");
    count_.fill_zero();
    executor_.run("keys", items,
                  CountCells<Key>{boxes, extent, shift, keys_.data(), count_.data(), ids_.data()});
    exclusive_scan(executor_, "sort", std::int64_t{1} << cell_bits_, count_.data(), begin_.data(),
                   temporary_.data(), temporary_.bytes());
    executor_.run("sort", items,
                  ScatterToCells<Key>{keys_.data(), shift, begin_.data(), ids_.data(), order_.data()});
    executor_.run(
        "sort", items,
        SettleCells<Key, Emit>{keys_.data(), shift, begin_.data(), order_.data(), sorted_keys_.data(), emit});
  }
#endif

  /// By place, ascending; after sort().
  const Key* keys() const { return sorted_keys_.data(); }
  /// By place, after the sort() that emits nothing.
  const std::uint32_t* bodies() const { return cell_bits_ > 0 ? ids_.data() : order_.data(); }

 private:
  std::uint32_t* bodies_by_place() { return cell_bits_ > 0 ? ids_.data() : order_.data(); }

  static constexpr int key_bits = sizeof(Key) == 4 ? 30 : 63;
  static constexpr std::int64_t most_cells = 1 << 21;  // their counters stay in a GPU's cache

  Executor& executor_;
  std::int64_t bodies_ = 0;
  int cell_bits_ = 0;  ///< 0: the library sorts
  int sorted_bits_ = 0;
  Buffer<Key> keys_, sorted_keys_;
  Buffer<std::uint32_t> ids_;  ///< ids; or of each body its rank in its cell
  Buffer<std::uint32_t> order_;
  Buffer<std::uint32_t> count_, begin_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
