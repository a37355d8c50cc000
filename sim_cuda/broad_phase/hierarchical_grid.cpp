// A hierarchical grid: one grid per size class of bodies, so that cells of small bodies stay small beside
// large bodies. A query searches the body's own level and all occupied coarser ones.
//
// Size classes are powers of two, from the extent down to 2^-21 of it, where floats no longer resolve
// neighbours. The first and last class also contain all smaller and larger bodies. A class with few bodies
// has no grid of its own, and joins a coarser one. Most scenes then need one or two levels. Each omitted
// level saves every finer body a search. The number of lists per level depends on its number of bodies, which
// is estimated from a sample.

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/cell_list.h"

namespace collidoscope {

namespace {

constexpr std::int32_t classes = CellGrid::classes;

/// The power of class 0. The extent itself is in the last class but one.
SIM_HD inline std::int32_t first_power(const Aabb& extent) {
  return CellGrid::power_of(longest_side(extent)) - (classes - 2);
}

struct SizeHistogram {
  std::uint64_t longest[classes];  ///< longest side of any box, as bits of a float > 0; 0 if there is none
  std::uint32_t sampled[classes];  ///< sampled bodies: each `every`-th
};

struct BuildSizeHistogram {
  const Aabb *boxes, *extent;
  std::int64_t bodies, lanes, every;
  SizeHistogram* histogram;
  SIM_HD void operator()(int lane) const {
    const std::int32_t power = first_power(*extent);
    float longest[classes] = {};
    for (std::int64_t body = lane; body < bodies; body += lanes) {
      const Aabb box = boxes[body];
      if (is_empty(box)) continue;
      const float side = longest_side(box);
      const std::int32_t c = CellGrid::class_of(side, power);
      longest[c] = max_of(longest[c], side);
      if (body % every == 0) atomic_add(&histogram->sampled[c], 1);
    }
    for (std::int32_t c = 0; c < classes; ++c)
      if (longest[c] > 0)
        atomic_max(&histogram->longest[c], std::uint64_t{std::bit_cast<std::uint32_t>(longest[c])});
  }
};

/// Lays out one class, if it is the coarsest class of a level. Finer classes join the level while it has at
/// most `max_joined` times as many bodies as its coarsest class alone. Solid bodies of that class fill only
/// their own cells, so the lists stay short.
struct LayOutLevel {
  static constexpr std::uint32_t max_joined = 16, lists_per_body = 2;
  const Aabb* extent;
  const SizeHistogram* histogram;
  std::uint32_t every;
  CellGrid* grid;
  SIM_HD void operator()(int item) const {
    std::int32_t level = 0, own_level = 0;
    std::uint32_t alone = 0, joined = 0, occupied = 0, lists = 0, first_list = 0;
    for (std::int32_t c = classes - 1; c >= 0; --c) {
      if (histogram->longest[c] == 0) continue;
      const std::uint32_t count = histogram->sampled[c] + 1;
      joined += count;
      if (joined > max_joined * alone) {
        level = c;
        alone = joined = count;
      }
      occupied |= 1u << level;
      if (c == item) own_level = level;
      if (level == item) lists += lists_per_body * every * count;
      if (level < item) first_list += lists_per_body * every * count;
    }
    grid->level_of[item] = own_level;
    if (item == 0) {
      grid->first_power = first_power(*extent);
      grid->occupied = occupied;
    }
    if ((occupied >> item & 1) == 0) return;
    const float reach = std::bit_cast<float>(static_cast<std::uint32_t>(histogram->longest[item]));
    grid->levels[item] = make_level(*extent, reach, lists);
    grid->levels[item].first_list = first_list;
  }
};

class HierarchicalGrid final : public BroadPhase {
 public:
  explicit HierarchicalGrid(Executor& executor)
      : executor_(executor), histogram_(executor, "size histogram"), cells_(executor) {}

  void reserve(std::int64_t bodies) override {
    bodies_ = bodies;
    every_ = (bodies + max_sampled - 1) / max_sampled;
    histogram_.resize_discarding(1);
    cells_.reserve(
        bodies,
        LayOutLevel::lists_per_body * (bodies + every_ * (classes + 1)));  // upper bound over all layouts
  }

  void update(const Aabb* boxes, const Aabb* extent) override {
    if (bodies_ == 0) return;
    const std::int64_t lanes = min_of(bodies_, histogram_lanes);
    executor_.begin_stage("keys");
    histogram_.fill_zero();
    executor_.run("keys", lanes,
                  BuildSizeHistogram{boxes, extent, bodies_, lanes, every_, histogram_.data()});
    executor_.run("keys", classes,
                  LayOutLevel{extent, histogram_.data(), static_cast<std::uint32_t>(every_), cells_.grid()});
    cells_.sort(boxes);
  }

  void find_pairs(const PairSink& sink) override { cells_.find_pairs(sink); }

 private:
  static constexpr std::int64_t max_sampled = 4096;

  Executor& executor_;
  std::int64_t bodies_ = 0, every_ = 0;
  Buffer<SizeHistogram> histogram_;
  CellList cells_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_hierarchical_grid(Executor& executor) {
  return std::make_unique<HierarchicalGrid>(executor);
}

}  // namespace collidoscope
