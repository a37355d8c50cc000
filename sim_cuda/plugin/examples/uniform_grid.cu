// Example of a broad-phase plug-in for CUDA: a uniform grid whose cells are as large as the largest box. Boxes are
// sorted by the cell of their centre; each box looks at the 27 cells around it, as nine rows of three.
//
//   nvcc -O2 -std=c++17 -shared -Xcompiler -fPIC -I <include> -o libcuda_grid.so uniform_grid.cu
//   collidoscope --broad-phase ./libcuda_grid.so
//
// All memory is allocated in create(). find() only enqueues work, so that a step can be captured as a graph.
#include <collidoscope/broad_phase.h>
#include <cuda_runtime.h>

#include <cub/device/device_radix_sort.cuh>

namespace {

using Key = unsigned long long;

constexpr int threads = 128;
constexpr int axis_bits = 20;  // cells per axis; larger scenes have larger cells
constexpr Key empty_box = ~Key{0};

/// Bits of a float in an order that integers have, for atomic minima and maxima.
__device__ unsigned ordered_bits(float x) {
  const unsigned bits = __float_as_uint(x);
  return bits >> 31 ? ~bits : bits | 0x80000000u;
}
__device__ float from_ordered_bits(unsigned bits) {
  return __uint_as_float(bits >> 31 ? bits & 0x7fffffffu : ~bits);
}

/// Ordered bits, over all boxes that are not empty.
struct Extent {
  unsigned min[3], max[3], side;
};

__device__ bool is_empty(const collidoscope_box& box) { return !(box.min[0] <= box.max[0]); }

__global__ void start_extent(Extent* extent) {
  for (int axis = 0; axis < 3; ++axis) {
    extent->min[axis] = ~0u;
    extent->max[axis] = 0;
  }
  extent->side = 0;
}

__global__ void find_extent(const collidoscope_box* boxes, unsigned count, Extent* extent) {
  const unsigned k = blockIdx.x * blockDim.x + threadIdx.x;
  if (k >= count || is_empty(boxes[k])) return;
  for (int axis = 0; axis < 3; ++axis) {
    atomicMin(&extent->min[axis], ordered_bits(boxes[k].min[axis]));
    atomicMax(&extent->max[axis], ordered_bits(boxes[k].max[axis]));
    atomicMax(&extent->side, ordered_bits(boxes[k].max[axis] - boxes[k].min[axis]));
  }
}

/// Side of a cell. It is above the side of every box, also with rounding, and gives at most 2^20 - 4 cells per axis.
__device__ double cell_side(const Extent& extent) {
  double side = 1.00001 * from_ordered_bits(extent.side) + 1e-30;
  for (int axis = 0; axis < 3; ++axis) {
    const double range = double{from_ordered_bits(extent.max[axis])} - from_ordered_bits(extent.min[axis]);
    side = fmax(side, range / ((1 << axis_bits) - 4));
  }
  return side;
}

/// Cells have coordinates from 1, so that neighbours are not negative.
__device__ Key key_of(Key x, Key y, Key z) { return (z << axis_bits | y) << axis_bits | x; }

__device__ void find_cell(const collidoscope_box& box, const Extent& extent, double side, Key (&cell)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    const double center = 0.5 * (double{box.min[axis]} + box.max[axis]);
    cell[axis] = 1 + static_cast<Key>((center - from_ordered_bits(extent.min[axis])) / side);
  }
}

__global__ void find_keys(const collidoscope_box* boxes, unsigned count, const Extent* extent, Key* keys, unsigned* ids) {
  const unsigned k = blockIdx.x * blockDim.x + threadIdx.x;
  if (k >= count) return;
  ids[k] = k;
  keys[k] = empty_box;
  if (is_empty(boxes[k])) return;
  Key cell[3];
  find_cell(boxes[k], *extent, cell_side(*extent), cell);
  keys[k] = key_of(cell[0], cell[1], cell[2]);
}

/// Index of the first key that is not below `key`.
__device__ unsigned lower_bound(const Key* keys, unsigned count, Key key) {
  unsigned first = 0;
  while (count > 0) {
    const unsigned half = count / 2;
    const bool below = keys[first + half] < key;
    first = below ? first + half + 1 : first;
    count = below ? count - half - 1 : half;
  }
  return first;
}

__device__ bool overlap(const collidoscope_box& a, const collidoscope_box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])) return false;
  return true;
}

__global__ void find_pairs(collidoscope_find f, const Extent* extent, const Key* keys, const unsigned* ids) {
  const unsigned place = blockIdx.x * blockDim.x + threadIdx.x;
  if (place >= f.count || keys[place] == empty_box) return;
  const unsigned id = ids[place];
  const collidoscope_box box = f.boxes[id];
  Key cell[3];
  find_cell(box, *extent, cell_side(*extent), cell);
  for (int row = 0; row < 9; ++row) {
    const Key y = cell[1] + row % 3 - 1, z = cell[2] + row / 3 - 1;
    const Key last = key_of(cell[0] + 1, y, z);
    for (unsigned k = lower_bound(keys, f.count, key_of(cell[0] - 1, y, z)); k < f.count && keys[k] <= last; ++k) {
      if (ids[k] <= id || !overlap(box, f.boxes[ids[k]])) continue;  // each pair from its lower id
      const unsigned long long at = atomicAdd(reinterpret_cast<unsigned long long*>(f.pair_count), 1ull);
      if (at < f.capacity) f.pairs[at] = {id, ids[k]};
    }
  }
}

struct Grid {
  Extent* extent = nullptr;
  Key *keys = nullptr, *sorted_keys = nullptr;
  unsigned *ids = nullptr, *sorted_ids = nullptr;
  void* temporary = nullptr;
  size_t temporary_bytes = 0;
};

cudaError_t sort(Grid& grid, unsigned count, cudaStream_t stream) {
  return cub::DeviceRadixSort::SortPairs(grid.temporary, grid.temporary_bytes, grid.keys, grid.sorted_keys, grid.ids,
                                         grid.sorted_ids, static_cast<int>(count), 0, 64, stream);
}

void destroy(void* object) {
  Grid* grid = static_cast<Grid*>(object);
  for (void* memory : {static_cast<void*>(grid->extent), static_cast<void*>(grid->keys), static_cast<void*>(grid->sorted_keys),
                       static_cast<void*>(grid->ids), static_cast<void*>(grid->sorted_ids), grid->temporary})
    cudaFree(memory);
  delete grid;
}

void* create(uint32_t, uint32_t count) {
  Grid* grid = new Grid;
  bool good = sort(*grid, count, nullptr) == cudaSuccess;  // without memory: computes temporary_bytes
  good = good && cudaMalloc(&grid->extent, sizeof(Extent)) == cudaSuccess;
  good = good && cudaMalloc(&grid->keys, count * sizeof(Key)) == cudaSuccess;
  good = good && cudaMalloc(&grid->sorted_keys, count * sizeof(Key)) == cudaSuccess;
  good = good && cudaMalloc(&grid->ids, count * sizeof(unsigned)) == cudaSuccess;
  good = good && cudaMalloc(&grid->sorted_ids, count * sizeof(unsigned)) == cudaSuccess;
  good = good && cudaMalloc(&grid->temporary, grid->temporary_bytes) == cudaSuccess;
  if (good) return grid;
  destroy(grid);
  return nullptr;
}

int find(void* object, const collidoscope_find* f) {
  Grid& grid = *static_cast<Grid*>(object);
  const auto stream = static_cast<cudaStream_t>(f->stream);
  const unsigned blocks = (f->count + threads - 1) / threads;
  f->begin_stage(f->context, "cells");
  start_extent<<<1, 1, 0, stream>>>(grid.extent);
  find_extent<<<blocks, threads, 0, stream>>>(f->boxes, f->count, grid.extent);
  find_keys<<<blocks, threads, 0, stream>>>(f->boxes, f->count, grid.extent, grid.keys, grid.ids);
  f->begin_stage(f->context, "sort cells");
  if (const cudaError_t status = sort(grid, f->count, stream); status != cudaSuccess) return status;
  f->begin_stage(f->context, "query cells");
  find_pairs<<<blocks, threads, 0, stream>>>(*f, grid.extent, grid.sorted_keys, grid.sorted_ids);
  return cudaGetLastError();
}

}  // namespace

COLLIDOSCOPE_EXPORT const collidoscope_broad_phase* collidoscope_broad_phase_v1(void) {
  static const collidoscope_broad_phase description = {
      COLLIDOSCOPE_BROAD_PHASE_VERSION, COLLIDOSCOPE_CUDA, "cuda_grid", "example: uniform grid, sorted by cell", create,
      destroy, find, nullptr};
  return &description;
}
