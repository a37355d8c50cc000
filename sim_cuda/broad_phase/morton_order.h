#pragma once
// Sorts bodies by Morton key, the first step of every BVH along the z-order curve. Owns the keys; owned by a
// broad phase.
//
// Keys have 24, 30 or 63 bits (ExecutorOptions::key_bits). All key bits are sorted; ties by id. The order
// therefore depends on the boxes only, not on the sort method, launch shape or lane order.
//
// Up to 2^21 bodies with 24- or 30-bit keys, a counting sort is used. It has about as many cells as bodies,
// with one counter each. A cell usually has one or two bodies, and each body finds its place within the cell
// by comparisons. It takes four launches; a radix sort takes eleven. A cell with many bodies is one large
// item, sorted by a block (LargeItems).
//
// The library's radix sort is used for more bodies and for 63-bit keys. ExecutorOptions::sort overrides this
// choice.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/broad_phase/counting_cells.h"
#include "sim_cuda/broad_phase/morton.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/radix_sort.h"
#include "sim_cuda/core/scan.h"
#include "sim_cuda/core/segment_sort.h"
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
  int dropped_bits, cell_shift;
  Key* keys;
  std::uint32_t *count, *rank;
  SIM_HD void operator()(int body) const {
    const Key key = morton_key<Key>(boxes[body], *extent) >> dropped_bits;
    keys[body] = key;
    rank[body] = atomic_add(&count[key >> cell_shift], 1);
  }
};

template <class Key>
struct ScatterToCells {
  const Key* keys;
  int cell_shift;
  const std::uint32_t *begin, *rank;
  std::uint32_t* unsorted;
  SIM_HD void operator()(int body) const {
    unsorted[begin[keys[body] >> cell_shift] + rank[body]] = static_cast<std::uint32_t>(body);
  }
};

/// Sorts the bodies of each cell, which are in arbitrary order, by (key, id). In a small cell, each body
/// counts the bodies before it. A large cell is sorted by the item of its first place: by a block on a GPU,
/// else by one thread.
template <class Emit>
struct SortWithinCells {
  const std::uint32_t* keys;
  int cell_shift;
  const std::uint32_t *begin, *unsorted;
  std::uint32_t *sorted_keys, *sorted;  ///< by place; `sorted` is used for large cells only, as scratch
  Emit emit;

  struct Cell {
    std::uint32_t first, size;
    SIM_HD bool is_large() const { return size > large_cell_size; }
  };
  SIM_HD Cell cell_of(std::uint32_t key) const {
    const std::uint32_t first = begin[key >> cell_shift];
    return {first, begin[(key >> cell_shift) + 1] - first};
  }

  SIM_HD void operator()(int k) const {
    const std::uint32_t body = unsorted[k], key = keys[body];
    const Cell cell = cell_of(key);
    if (cell.is_large()) {
      if (static_cast<std::uint32_t>(k) == cell.first) sort_by_thread(cell);
      return;
    }
    std::uint32_t place = cell.first;
    for (std::uint32_t j = cell.first; j < cell.first + cell.size; ++j) {
      const std::uint32_t other = unsorted[j];
      const std::uint32_t other_key = keys[other];
      place += other_key < key || (other_key == key && other < body);
    }
    sorted_keys[place] = key;
    emit(place, body);
  }
  SIM_HD void copy_key(std::uint32_t place) const {
    sorted[place] = unsorted[place];
    sorted_keys[place] = keys[unsorted[place]];
  }
  SIM_HD KeyedSegment run(const Cell& cell) const { return {sorted_keys + cell.first, sorted + cell.first}; }
  SIM_HD void sort_by_thread(const Cell& cell) const {
    for (std::uint32_t i = 0; i < cell.size; ++i) copy_key(cell.first + i);
    sort_run(run(cell), cell.size);
    for (std::uint32_t i = 0; i < cell.size; ++i) emit(cell.first + i, sorted[cell.first + i]);
  }

  SIM_HD bool is_large(int k) const {
    const Cell cell = cell_of(keys[unsorted[k]]);
    return cell.is_large() && static_cast<std::uint32_t>(k) == cell.first;
  }
#if defined(__CUDACC__)
  __device__ void process_by_block(int k) const {
    const Cell cell = cell_of(keys[unsorted[k]]);
    for (std::uint32_t i = threadIdx.x; i < cell.size; i += blockDim.x) copy_key(cell.first + i);
    __syncthreads();
    sort_run_by_block(run(cell), cell.size);
    for (std::uint32_t i = threadIdx.x; i < cell.size; i += blockDim.x)
      emit(cell.first + i, sorted[cell.first + i]);
  }
#endif
};

template <class Emit>
struct ScatterInOrder {
  const std::uint32_t* order;
  Emit emit;
  SIM_HD void operator()(int place) const { emit(static_cast<std::uint32_t>(place), order[place]); }
};

struct StoreBody {
  std::uint32_t* body_at;
  SIM_HD void operator()(std::uint32_t place, std::uint32_t body) const { body_at[place] = body; }
};

template <class Key>
class MortonOrder {
 public:
  explicit MortonOrder(Executor& executor)
      : executor_(executor),
        key_bits_(sizeof(Key) == 8                    ? 63
                  : executor.options().key_bits == 24 ? 24
                                                      : 30),
        keys_(executor, "Morton keys"),
        sorted_keys_(executor, "sorted Morton keys"),
        ids_(executor, "unsorted ids"),
        order_(executor, "ids in Morton order"),
        count_(executor, "bodies per cell"),
        begin_(executor, "cell starts"),
        temporary_(executor, "sort workspace") {}

  void reserve(std::int64_t bodies) {
    bodies_ = bodies;
    const auto n = static_cast<std::size_t>(bodies);
    for (Buffer<Key>* keys : {&keys_, &sorted_keys_}) keys->resize_discarding(n);
    for (Buffer<std::uint32_t>* ids : {&ids_, &order_}) ids->resize_discarding(n);
    const SortMethod method = executor_.options().sort;
    cell_bits_ = sizeof(Key) == 4 && sorts_by_counting(method, bodies) ? counting_cell_bits(bodies) : 0;
    const std::size_t cells = cell_bits_ > 0 ? (std::size_t{1} << cell_bits_) + 1 : 0;
    count_.resize_discarding(cells);
    begin_.resize_discarding(cells);
    temporary_.resize_discarding(
        cells > 0                     ? scan_temporary_bytes(executor_, static_cast<std::int64_t>(cells) - 1)
        : method == SortMethod::radix ? radix_sort_temporary_bytes(bodies)
                                      : sort_temporary_bytes<Key>(executor_, bodies, key_bits_));
  }

#if !SIM_CUDA || defined(__CUDACC__)
  /// Calls emit(place, body) once per place 0 .. bodies - 1, in the stage "sort". `extent` as in
  /// morton_key().
  template <class Emit>
  void sort(const Aabb* boxes, const Aabb* extent, const Emit& emit) {
    sort(boxes, extent, emit, bodies_);
  }
  /// Sorts without emit; use bodies() afterwards.
  void sort(const Aabb* boxes, const Aabb* extent) { sort(boxes, extent, StoreBody{bodies_by_place()}); }
  /// Variant with an item count, which must be all bodies or 0. With 0, nothing is emitted, and keys() keep
  /// the result of the last sort.
  template <class Emit>
  void sort(const Aabb* boxes, const Aabb* extent, const Emit& emit, const ItemCount& items) {
    constexpr int all_bits = sizeof(Key) == 4 ? 30 : 63;
    const int dropped_bits = all_bits - key_bits_;
    if constexpr (sizeof(Key) == 4) {
      if (cell_bits_ > 0) return sort_by_counting(boxes, extent, emit, items, dropped_bits);
    }
    const bool in_place = executor_.options().sort == SortMethod::radix;
    Key* const keys = in_place ? sorted_keys_.data() : keys_.data();
    std::uint32_t* const ids = in_place ? order_.data() : ids_.data();
    executor_.run("keys", items, MakeKeys<Key>{boxes, extent, dropped_bits, keys, ids});
    if (in_place)
      radix_sort(executor_, "sort", bodies_, key_bits_, keys, ids, keys_.data(), ids_.data(),
                 temporary_.data());
    else
      sort_by_key(executor_, "sort", bodies_, key_bits_, keys, sorted_keys_.data(), ids, order_.data(),
                  temporary_.data(), temporary_.bytes());
    if constexpr (!std::is_same_v<Emit, StoreBody>)  // bodies() has the result already
      executor_.run("sort", items, ScatterInOrder<Emit>{order_.data(), emit});
  }
#endif

  int key_bits() const { return key_bits_; }
  /// Sorted keys, by place. Valid after sort().
  const Key* keys() const { return sorted_keys_.data(); }
  /// Body ids by place. Valid after the sort() without emit.
  const std::uint32_t* bodies() const { return cell_bits_ > 0 ? ids_.data() : order_.data(); }

 private:
#if !SIM_CUDA || defined(__CUDACC__)
  template <class Emit>
  void sort_by_counting(const Aabb* boxes, const Aabb* extent, const Emit& emit, const ItemCount& items,
                        int dropped_bits) {
    const int shift = key_bits_ - cell_bits_;
    executor_.begin_stage("keys");
    count_.fill_zero();
    executor_.run(
        "keys", items,
        CountCells<Key>{boxes, extent, dropped_bits, shift, keys_.data(), count_.data(), ids_.data()});
    exclusive_scan(executor_, "sort", std::int64_t{1} << cell_bits_, count_.data(), begin_.data(),
                   temporary_.data(), temporary_.bytes());
    executor_.run("sort", items,
                  ScatterToCells<Key>{keys_.data(), shift, begin_.data(), ids_.data(), order_.data()});
    // The ranks are no longer needed; their memory is reused for the bodies of large cells.
    executor_.run("sort", items,
                  SortWithinCells<Emit>{keys_.data(), shift, begin_.data(), order_.data(),
                                        sorted_keys_.data(), ids_.data(), emit});
  }
#endif
  std::uint32_t* bodies_by_place() { return cell_bits_ > 0 ? ids_.data() : order_.data(); }

  Executor& executor_;
  int key_bits_;
  std::int64_t bodies_ = 0;
  int cell_bits_ = 0;  ///< 0: no counting sort
  Buffer<Key> keys_, sorted_keys_;
  /// Ids; with counting, ranks of bodies within their cell, then bodies by place.
  Buffer<std::uint32_t> ids_;
  Buffer<std::uint32_t> order_;
  Buffer<std::uint32_t> count_, begin_;
  Buffer<std::byte> temporary_;
};

}  // namespace collidoscope
