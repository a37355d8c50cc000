#include "headless/bench/cubql_baseline.h"

#include "sim_cuda/core/error.h"

#if BENCH_CUBQL
#define CUBQL_GPU_BUILDER_IMPLEMENTATION 1
#include <cuBQL/bvh.h>  // must precede all other cuBQL headers

#include <cuBQL/traversal/fixedBoxQuery.h>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/core/cuda_check.h"
#endif

namespace collidoscope {

#if BENCH_CUBQL

namespace {

using BaselineBox = cuBQL::box3f;
static_assert(sizeof(BaselineBox) == sizeof(Aabb));

__global__ void find_pairs(cuBQL::bvh3f tree, const BaselineBox* boxes, std::uint32_t n, Pair* pairs,
                           unsigned long long room, unsigned long long* count) {
  const std::uint32_t body = blockIdx.x * blockDim.x + threadIdx.x;
  if (body >= n) return;
  const BaselineBox box = boxes[body];
  const auto visit = [=](std::uint32_t other) {
    if (other > body && box.overlaps(boxes[other])) {
      const unsigned long long place = atomicAdd(count, 1ull);
      if (place < room) pairs[place] = {body, other};
    }
    return CUBQL_CONTINUE_TRAVERSAL;
  };
  cuBQL::fixedBoxQuery::forEachPrim(visit, tree, box);
}

template <class T>
struct DeviceArray {
  T* data = nullptr;
  explicit DeviceArray(std::size_t size) {
    check(cudaMalloc(reinterpret_cast<void**>(&data), size * sizeof(T)), "allocate memory for cuBQL");
  }
  ~DeviceArray() { cudaFree(data); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;
};

}  // namespace

bool has_cubql() { return true; }

BaselineTimes time_cubql(std::span<const Aabb> boxes, int repeats) {
  BaselineTimes times;
  const auto n = static_cast<std::uint32_t>(boxes.size());
  if (n == 0) return times;
  const DeviceArray<BaselineBox> on_device(n);
  const DeviceArray<unsigned long long> count(1);
  check(cudaMemcpy(on_device.data, boxes.data(), boxes.size_bytes(), cudaMemcpyHostToDevice), "copy boxes");
  cudaStream_t stream = nullptr;
  cudaEvent_t start = nullptr, end = nullptr;
  check(cudaStreamCreate(&stream), "create a stream");
  check(cudaEventCreate(&start), "create an event");
  check(cudaEventCreate(&end), "create an event");

  const auto once = [&](Pair* pairs, std::size_t room) {
    check(cudaEventRecord(start, stream), "record an event");
    cuBQL::bvh3f tree;
    cuBQL::cuda::radixBuilder(tree, on_device.data, n, cuBQL::BuildConfig{}, stream);
    check(cudaMemsetAsync(count.data, 0, sizeof *count.data, stream), "clear the counter of pairs");
    constexpr std::uint32_t threads = 128;
    find_pairs<<<(n + threads - 1) / threads, threads, 0, stream>>>(tree, on_device.data, n, pairs, room,
                                                                    count.data);
    check(cudaPeekAtLastError(), "launch the cuBQL query");
    times.bytes =
        static_cast<std::int64_t>(tree.numNodes * sizeof(cuBQL::bvh3f::node_t) + n * sizeof(std::uint32_t));
    cuBQL::cuda::free(tree, stream);
    check(cudaEventRecord(end, stream), "record an event");
    check(cudaStreamSynchronize(stream), "run cuBQL");
    float ms = 0;
    check(cudaEventElapsedTime(&ms, start, end), "read the elapsed time");
    unsigned long long found = 0;
    check(cudaMemcpy(&found, count.data, sizeof found, cudaMemcpyDeviceToHost), "read the counter of pairs");
    times.pairs = static_cast<std::int64_t>(found);
    return ms;
  };
  once(nullptr, 0);  // counts the pairs
  const auto room = static_cast<std::size_t>(times.pairs);
  const DeviceArray<Pair> pairs(room > 0 ? room : 1);
  constexpr int warm_up = 3;
  for (int k = -warm_up; k < repeats; ++k) {
    const float ms = once(pairs.data, room);
    if (k >= 0) times.ms.push_back(ms);
  }
  cudaEventDestroy(start);
  cudaEventDestroy(end);
  cudaStreamDestroy(stream);
  return times;
}

#else

bool has_cubql() { return false; }

BaselineTimes time_cubql(std::span<const Aabb>, int) {
  throw MachineError("cuBQL: this build has no cuBQL support; configure with -DCOLLIDOSCOPE_CUBQL=FOLDER");
}

#endif

}  // namespace collidoscope
