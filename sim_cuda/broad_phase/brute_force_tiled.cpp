// Tiled brute force: each tile of bodies is tested against its own and all later tiles, so that a loaded box
// is used many times. On a GPU, a block of T threads keeps a tile in shared memory and the boxes of 4 T other
// bodies in registers. On the CPU, a tile is in the L1 cache, one array per coordinate, so that the compiler
// can vectorise the tests. Both find the same pairs, because the tests involve no rounding.

#include <algorithm>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/pair_code.h"
#include "sim_cuda/broad_phase/pair_sink.h"

namespace collidoscope {

namespace {

constexpr std::uint32_t row_tiles = 4;  ///< row tiles per tile of columns

[[maybe_unused]] constexpr std::uint32_t hits_per_thread = 1;  ///< capacity per thread of the buffer of hits

/// Unit of work: the rows first_row .. first_row + 4 * tile - 1 against the columns first_column ..
/// first_column + tile - 1. All units together cover every pair row < column. Units on the diagonal also
/// contain other pairs, and row tiles may extend beyond the last body.
struct TileUnit {
  std::uint32_t first_row, first_column;

  SIM_HD TileUnit(std::uint64_t unit, std::uint32_t tile) {
    const Pair group = decode_pair(unit / row_tiles);  // of 4 tiles; (a, b) encodes a against b - 1 >= a
    first_row = group.a * row_tiles * tile;
    first_column = ((group.b - 1) * row_tiles + static_cast<std::uint32_t>(unit % row_tiles)) * tile;
  }
  static std::uint64_t count(std::uint64_t bodies, std::uint64_t tile) {
    const std::uint64_t groups = (bodies + row_tiles * tile - 1) / (row_tiles * tile);
    return row_tiles * pair_count(groups + 1);
  }
};

/// CPU version.
struct TestTiles {
  static constexpr std::uint32_t tile = 256, lanes = 16;
  const Aabb* boxes;
  std::uint32_t bodies;
  std::uint64_t units, items;
  PairSink sink;

  SIM_HD void operator()(int item) const {
    for (auto unit = static_cast<std::uint64_t>(item); unit < units; unit += items)
      test(TileUnit(unit, tile));
  }

  SIM_HD void test(const TileUnit& unit) const {
    if (unit.first_column >= bodies) return;
    float low[3][tile], high[3][tile];
    for (std::uint32_t c = 0; c < tile; ++c) {
      const Aabb box = unit.first_column + c < bodies ? boxes[unit.first_column + c] : Aabb::empty();
      for (int k = 0; k < 3; ++k) {
        low[k][c] = box.min[k];
        high[k][c] = box.max[k];
      }
    }
    for (std::uint32_t row = unit.first_row; row < unit.first_row + row_tiles * tile && row < bodies; ++row) {
      const Aabb box = boxes[row];
      const std::uint32_t own = row < unit.first_column ? 0 : row - unit.first_column;  // skipped columns
      for (std::uint32_t c = own / lanes * lanes; c < tile; c += lanes) {
        std::uint32_t hit[lanes], any = 0;
        for (std::uint32_t k = 0; k < lanes; ++k) {
          hit[k] = static_cast<std::uint32_t>((low[0][c + k] <= box.max[0]) & (box.min[0] <= high[0][c + k]) &
                                              (low[1][c + k] <= box.max[1]) & (box.min[1] <= high[1][c + k]) &
                                              (low[2][c + k] <= box.max[2]) & (box.min[2] <= high[2][c + k]));
          any |= hit[k];
        }
        if (any == 0) continue;
        for (std::uint32_t k = 0; k < lanes; ++k) {
          const std::uint32_t column = unit.first_column + c + k;
          if (hit[k] != 0 && row < column && column < bodies) sink.add(row, column);
        }
      }
    }
  }
};

#if defined(__CUDACC__)

/// GPU version: blocks of T threads run the units in a grid-stride loop, with tiles of T bodies. A hit costs
/// a warp far more than a test. Hits are therefore buffered in shared memory, and written together after the
/// unit. Hits that do not fit are written immediately.
__global__ void __launch_bounds__(1024)
    test_tiles(const Aabb* boxes, std::uint32_t bodies, std::uint64_t units, PairSink sink) {
  extern __shared__ float4 shared[];
  __shared__ std::uint32_t hit_count;
  __shared__ unsigned long long first_place;
  const std::uint32_t tile = blockDim.x, thread = threadIdx.x;
  float4* const column_boxes = shared;  // two per body of the tile: {min, -}, {max, -}
  Pair* const hits = reinterpret_cast<Pair*>(shared + 2 * tile);
  const std::uint32_t hit_capacity = hits_per_thread * tile;
  const auto load = [=](std::uint32_t body) { return body < bodies ? boxes[body] : Aabb::empty(); };

  for (std::uint64_t number = blockIdx.x; number < units; number += gridDim.x) {
    const TileUnit unit(number, tile);
    if (unit.first_column >= bodies) continue;  // uniform over the block
    const Aabb own_column = load(unit.first_column + thread);
    column_boxes[2 * thread] = {own_column.min[0], own_column.min[1], own_column.min[2], 0};
    column_boxes[2 * thread + 1] = {own_column.max[0], own_column.max[1], own_column.max[2], 0};
    if (thread == 0) hit_count = 0;
    __syncthreads();

    Aabb row_box[row_tiles];
    for (std::uint32_t r = 0; r < row_tiles; ++r) row_box[r] = load(unit.first_row + r * tile + thread);
    for (std::uint32_t c = 0; c < tile; ++c) {
      const float4 low = column_boxes[2 * c], high = column_boxes[2 * c + 1];
      const Aabb box{Vector3f(low.x, low.y, low.z), Vector3f(high.x, high.y, high.z)};
      std::uint32_t overlaps = 0;
      for (std::uint32_t r = 0; r < row_tiles; ++r)
        overlaps |= static_cast<std::uint32_t>(overlap(row_box[r], box)) << r;
      for (std::uint32_t r = 0; overlaps >> r != 0; ++r) {
        const Pair pair{unit.first_row + r * tile + thread, unit.first_column + c};
        if ((overlaps >> r & 1) == 0 || pair.a >= pair.b || pair.b >= bodies) continue;
        const std::uint32_t place = atomicAdd(&hit_count, 1);
        if (place < hit_capacity)
          hits[place] = pair;
        else
          sink.add(pair.a, pair.b);
      }
    }
    __syncthreads();

    const std::uint32_t count = hit_count < hit_capacity ? hit_count : hit_capacity;
    if (thread == 0 && count > 0)
      first_place = atomicAdd(reinterpret_cast<unsigned long long*>(sink.total), count);
    __syncthreads();
    for (std::uint32_t k = thread; k < count; k += tile) sink.put(first_place + k, hits[k].a, hits[k].b);
    __syncthreads();  // shared memory may be overwritten from here on
  }
}

#endif

class BruteForceTiled final : public BroadPhase {
 public:
  explicit BruteForceTiled(Executor& executor) : executor_(executor) {}
  void reserve(std::int64_t bodies) override { bodies_ = static_cast<std::uint32_t>(bodies); }
  void update(const Aabb* boxes, const Aabb*) override { boxes_ = boxes; }

  void find_pairs(const PairSink& sink) override {
    if (bodies_ < 2) return;
#if defined(__CUDACC__)
    if (executor_.on_device()) return find_pairs_on_device(sink);
#endif
    const std::uint64_t units = TileUnit::count(bodies_, TestTiles::tile);
    const std::uint64_t items = std::min<std::uint64_t>(units, 1u << 30);  // the item index is an int
    executor_.run("pairs", static_cast<std::int64_t>(items), TestTiles{boxes_, bodies_, units, items, sink});
  }

 private:
#if defined(__CUDACC__)
  void find_pairs_on_device(const PairSink& sink) {
    executor_.begin_stage("pairs");
    LaunchShape shape = executor_.options().shape;
    if (shape.threads == 0) shape.threads = 64;  // small tiles give better load balance
    const auto tile = static_cast<std::uint32_t>(shape.threads);
    const std::uint64_t units = TileUnit::count(bodies_, tile);
    if (shape.blocks == 0) shape.blocks = static_cast<int>(std::min<std::uint64_t>(units, 1 << 16));
    const std::size_t shared_bytes = (2 * sizeof(float4) + hits_per_thread * sizeof(Pair)) * tile;
    test_tiles<<<shape.blocks, shape.threads, shared_bytes, executor_.stream()>>>(boxes_, bodies_, units,
                                                                                  sink);
    check(cudaPeekAtLastError(), "launch brute_force_tiled as " + std::to_string(shape.blocks) +
                                     " blocks of " + std::to_string(shape.threads) + " threads");
  }
#endif

  Executor& executor_;
  std::uint32_t bodies_ = 0;
  const Aabb* boxes_ = nullptr;
};

}  // namespace

std::unique_ptr<BroadPhase> make_brute_force_tiled(Executor& executor) {
  return std::make_unique<BruteForceTiled>(executor);
}

}  // namespace collidoscope
