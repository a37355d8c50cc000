// Brute force, the paper's naive approach (its 3.2.1, Table 1). Pairs of bodies are numbered, and the numbers
// are distributed over the threads. It needs no tree, no sort and no memory. It is the reference for all
// other methods.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/pair_code.h"
#include "sim_cuda/broad_phase/pair_sink.h"

namespace collidoscope {

namespace {

/// One item tests `run` pairs, `stride` apart. Only its first pair is decoded; the others are counted up from
/// it. Adjacent items start at adjacent pairs. With a stride of the warp size, a warp therefore reads
/// adjacent boxes.
struct TestPairs {
  const Aabb* boxes;
  std::uint64_t pairs;
  std::uint64_t run, stride;
  PairSink sink;
  SIM_HD void operator()(int item) const {
    const auto group = static_cast<std::uint64_t>(item) / stride,
               lane = static_cast<std::uint64_t>(item) % stride;
    const std::uint64_t first = group * run * stride + lane, end = (group + 1) * run * stride;
    auto [a, b] = decode_pair(first);
    for (std::uint64_t pair = first; pair < end && pair < pairs; pair += stride) {
      if (overlap(boxes[a], boxes[b])) sink.add(a, b);
      for (a += static_cast<std::uint32_t>(stride); a >= b; ++b) a -= b;
    }
  }
};

class BruteForce final : public BroadPhase {
 public:
  explicit BruteForce(Executor& executor) : executor_(executor) {}
  void reserve(std::int64_t bodies) override { pairs_ = pair_count(static_cast<std::uint64_t>(bodies)); }
  void update(const Aabb* boxes, const Aabb*) override { boxes_ = boxes; }

  void find_pairs(const PairSink& sink) override {
    // One pair per item, up to the number of items that fills all threads. Beyond, the run length is a power
    // of two, so that the number of items fits in an int.
    const std::uint64_t stride = executor_.on_device() ? 32 : 1;
    const std::uint64_t max_items = executor_.on_device() ? 1 << 21 : 1 << 14;
    std::uint64_t run = 1;
    while (pairs_ / run > max_items) run *= 2;
    const std::uint64_t groups = (pairs_ + run * stride - 1) / (run * stride);
    executor_.run("pairs", static_cast<std::int64_t>(groups * stride),
                  TestPairs{boxes_, pairs_, run, stride, sink});
  }

 private:
  Executor& executor_;
  std::uint64_t pairs_ = 0;
  const Aabb* boxes_ = nullptr;
};

}  // namespace

std::unique_ptr<BroadPhase> make_brute_force(Executor& executor) {
  return std::make_unique<BruteForce>(executor);
}

}  // namespace collidoscope
