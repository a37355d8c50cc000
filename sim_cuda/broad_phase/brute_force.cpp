// Every body against every other: the paper's naive approach (its 3.2.1), the oracle of all tests.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/pair_sink.h"

namespace collidoscope {

namespace {

struct TestAll {
  const Aabb* boxes;
  std::uint32_t bodies;
  PairSink sink;
  SIM_HD void operator()(int item) const {
    const auto body = static_cast<std::uint32_t>(item);
    const Aabb box = boxes[body];
    PairBatch batch(sink, body);
    for (std::uint32_t other = body + 1; other < bodies; ++other)
      if (overlap(box, boxes[other])) batch.add(other);
    batch.finish();
  }
};

class BruteForce final : public BroadPhase {
 public:
  explicit BruteForce(Executor& executor) : executor_(executor) {}
  void reserve(std::int64_t bodies) override { bodies_ = static_cast<std::uint32_t>(bodies); }
  void update(const Aabb* boxes, const Aabb*) override { boxes_ = boxes; }
  void find_pairs(const PairSink& sink) override {
    executor_.run("pairs", bodies_, TestAll{boxes_, bodies_, sink});
  }

 private:
  Executor& executor_;
  std::uint32_t bodies_ = 0;
  const Aabb* boxes_ = nullptr;
};

}  // namespace

std::unique_ptr<BroadPhase> make_brute_force(Executor& executor) {
  return std::make_unique<BruteForce>(executor);
}

}  // namespace collidoscope
