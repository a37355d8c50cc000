#include "sim_cuda/broad_phase/cell_list.h"

#include "sim_cuda/core/scan.h"

namespace collidoscope {

namespace {

using Entry = CellList::Entry;

SIM_HD inline bool overlap(const Entry& a, const Entry& b) {
  return (a.min[0] <= b.max[0]) & (b.min[0] <= a.max[0]) & (a.min[1] <= b.max[1]) & (b.min[1] <= a.max[1]) &
         (a.min[2] <= b.max[2]) & (b.min[2] <= a.max[2]);
}

/// Level and list of a body. Empty boxes have no level; they go to an additional last list, which is never
/// searched.
struct PlaceBody {
  const Aabb* boxes;
  const CellGrid* grid;
  std::uint32_t empties;

  SIM_HD std::int32_t level(const Aabb& box) const {
    return is_empty(box) ? -1 : grid->level_of[CellGrid::class_of(longest_side(box), grid->first_power)];
  }
  SIM_HD std::uint32_t list(const Aabb& box, std::int32_t level) const {
    return level < 0 ? empties : grid->levels[level].list_of(box.min.data());
  }
};

struct CountBodies {
  PlaceBody place;
  std::uint32_t* count;
  SIM_HD void operator()(int body) const {
    const Aabb box = place.boxes[body];
    atomic_add(&count[place.list(box, place.level(box))], 1);
  }
};

/// The order within a list is arbitrary. It determines which of two bodies finds their pair, not whether the
/// pair is found.
struct PutBodies {
  PlaceBody place;
  const std::uint32_t* start;
  std::uint32_t* count;
  Entry* entries;
  SIM_HD void operator()(int body) const {
    const Aabb box = place.boxes[body];
    const Entry entry{{box.min.x(), box.min.y(), box.min.z()},
                      static_cast<std::uint32_t>(body),
                      {box.max.x(), box.max.y(), box.max.z()},
                      place.level(box)};
    const std::uint32_t list = place.list(box, entry.level);
    entries[start[list] + atomic_add(&count[list], ~std::uint32_t{0}) - 1] = entry;  // counts down to 0
  }
};

/// One body's query. A pair is found by the body whose entry comes first; with different levels, this is the
/// body in the finer level.
struct QueryCells {
  const CellGrid* grid;
  const std::uint32_t* start;
  const Entry* entries;
  PairSink sink;

  SIM_HD void operator()(int item) const {
    const auto own_place = static_cast<std::uint32_t>(item);
    const Entry own = entries[own_place];
    if (own.level < 0) return;
    PairBatch batch(sink, own.body);
    const std::uint32_t own_list = grid->levels[own.level].list_of(own.min);
    const std::uint32_t occupied = grid->occupied;
    for (std::int32_t k = own.level; occupied >> k != 0; ++k) {
      if ((occupied >> k & 1) == 0) continue;
      const GridLevel& level = grid->levels[k];
      std::uint32_t low[3], count[3];
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = level.index(axis, next_down(own.min[axis] - level.reach));
        count[axis] = level.index(axis, own.max[axis]) - low[axis] + 1;
        count[axis] = min_of(count[axis], level.period[axis]);  // visits no list twice
        low[axis] = level.wrap(axis, low[axis]);
      }
      for (std::uint32_t z = low[2]; z < low[2] + count[2]; ++z)
        for (std::uint32_t y = low[1]; y < low[1] + count[1]; ++y) {
          // The lists of a row are one contiguous run of entries, or two if the row wraps around.
          const std::uint32_t row = level.list(0, level.wrap(1, y), level.wrap(2, z));
          std::uint32_t first = low[0], end = first + count[0];
          for (bool more = true; more; first = 0, end -= level.period[0]) {
            more = end > level.period[0];
            const std::uint32_t last = row + (more ? level.period[0] : end);
            if (last > own_list) search(own, own_place, start[row + first], start[last], batch);
          }
        }
    }
    batch.finish();
  }

 private:
  SIM_HD void search(const Entry& own, std::uint32_t own_place, std::uint32_t first, std::uint32_t end,
                     PairBatch& batch) const {
    for (std::uint32_t k = max_of(first, own_place + 1); k < end; ++k) {
      const Entry other = entries[k];
      if (overlap(own, other)) batch.add(other.body);
    }
  }
};

}  // namespace

CellList::CellList(Executor& executor)
    : executor_(executor),
      grid_(executor, "grid levels"),
      count_(executor, "bodies per cell"),
      start_(executor, "cell starts"),
      entries_(executor, "bodies by cell"),
      temporary_(executor, "scan workspace") {}

void CellList::reserve(std::int64_t bodies, std::int64_t lists) {
  bodies_ = bodies;
  lists_ = lists;
  const auto with_empties = static_cast<std::size_t>(lists) + 1;
  grid_.resize_discarding(1);
  grid_.fill_zero();
  count_.resize_discarding(with_empties + 1);
  count_.fill_zero();
  start_.resize_discarding(with_empties + 1);
  entries_.resize_discarding(static_cast<std::size_t>(bodies));
  temporary_.resize_discarding(scan_temporary_bytes(executor_, lists + 1));
}

void CellList::sort(const Aabb* boxes) {
  const PlaceBody place{boxes, grid_.data(), static_cast<std::uint32_t>(lists_)};
  executor_.run("keys", bodies_, CountBodies{place, count_.data()});
  exclusive_scan(executor_, "sort", lists_ + 1, count_.data(), start_.data(), temporary_.data(),
                 temporary_.bytes());
  executor_.run("sort", bodies_, PutBodies{place, start_.data(), count_.data(), entries_.data()});
}

void CellList::find_pairs(const PairSink& sink) {
  executor_.run("pairs", bodies_, QueryCells{grid_.data(), start_.data(), entries_.data(), sink});
}

}  // namespace collidoscope
