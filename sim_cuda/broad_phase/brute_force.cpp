// Every body against every other: the paper's naive approach (its 3.2.1), the oracle of all tests.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/query.h"

namespace collidoscope {

namespace {

struct AllBodies {
  const Aabb* boxes;
  std::uint32_t bodies;
  SIM_HD std::uint32_t body(int slot) const { return static_cast<std::uint32_t>(slot); }
  template <class Visit>
  SIM_HD void operator()(int slot, Visit&& visit) const {
    const Aabb box = boxes[slot];
    for (std::uint32_t other = body(slot) + 1; other < bodies; ++other)
      if (overlap(box, boxes[other])) visit(other);
  }
};

class BruteForce final : public BroadPhase {
 public:
  explicit BruteForce(Executor& executor) : executor_(executor) {}
  void reserve(std::int64_t bodies) override { query_.bodies = static_cast<std::uint32_t>(bodies); }
  void update(const Aabb* boxes, const Aabb*) override { query_.boxes = boxes; }
  void count_pairs(std::uint32_t* count) override {
    executor_.run("pairs", query_.bodies, CountPairs<AllBodies>{query_, count});
  }
  void write_pairs(const std::uint64_t* offset, std::uint32_t* second, const StepControl* control) override {
    executor_.run("pairs", query_.bodies, WritePairs<AllBodies>{query_, offset, second, control});
  }

 private:
  Executor& executor_;
  AllBodies query_{};
};

}  // namespace

std::unique_ptr<BroadPhase> make_brute_force(Executor& executor) {
  return std::make_unique<BruteForce>(executor);
}

}  // namespace collidoscope
