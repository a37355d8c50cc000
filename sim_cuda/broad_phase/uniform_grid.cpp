// A uniform grid with one cell size for all bodies, so that a query searches a few rows of cells around a
// body. Cell sizes range from a quarter of the longest side of any box to twice that side. The smallest size
// that needs at most two cells per body is used.
//
// The number of cells is bounded by the number of bodies, for any extent (cell_list.h). A uniform grid
// handles mixed sizes badly: one huge body makes all cells huge, and the method degenerates to brute force
// (measured by Liu et al. 2010). Use hierarchical_grid for mixed sizes.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/cell_list.h"

namespace collidoscope {

namespace {

/// The longest side of any box, as the bits of a float >= 0. Such bits have the order of the floats.
struct FindLargest {
  const Aabb* boxes;
  std::int64_t bodies, lanes;
  std::uint64_t* largest;
  SIM_HD void operator()(int lane) const {
    float side = 0;
    for (std::int64_t body = lane; body < bodies; body += lanes)
      side = max_of(side, longest_side(boxes[body]));
    atomic_max(largest, std::uint64_t{std::bit_cast<std::uint32_t>(side)});
  }
};

struct LayOutGrid {
  const Aabb* extent;
  const std::uint64_t* largest;
  std::uint64_t lists;
  CellGrid* grid;
  SIM_HD void operator()(int) const {
    grid->first_power = CellGrid::max_power;  // all bodies are in class 0
    grid->level_of[0] = 0;
    grid->occupied = 1;
    grid->levels[0] = make_level(*extent, std::bit_cast<float>(static_cast<std::uint32_t>(*largest)), lists);
  }
};

class UniformGrid final : public BroadPhase {
 public:
  explicit UniformGrid(Executor& executor)
      : executor_(executor), largest_(executor, "largest box side"), cells_(executor) {}

  void reserve(std::int64_t bodies) override {
    bodies_ = bodies;
    largest_.resize_discarding(1);
    cells_.reserve(bodies, lists());
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    if (bodies_ == 0) return;
    const std::int64_t lanes = min_of(bodies_, histogram_lanes);
    executor_.begin_stage("keys");
    largest_.fill_zero();
    executor_.run("keys", lanes, FindLargest{boxes, bodies_, lanes, largest_.data()});
    executor_.run("keys", 1,
                  LayOutGrid{extent, largest_.data(), static_cast<std::uint64_t>(lists()), cells_.grid()});
    cells_.sort(boxes);
  }

  void find_pairs(const PairSink& sink) override { cells_.find_pairs(sink); }

 private:
  std::int64_t lists() const { return 2 * bodies_ + 64; }

  Executor& executor_;
  std::int64_t bodies_ = 0;
  Buffer<std::uint64_t> largest_;
  CellList cells_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_uniform_grid(Executor& executor) {
  return std::make_unique<UniformGrid>(executor);
}

}  // namespace collidoscope
