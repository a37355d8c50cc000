#include "sim_cuda/run/box_query.h"

#include <algorithm>

#include "sim_cuda/broad_phase/key_bits.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/run/broad_phase_times.h"

namespace collidoscope {
namespace {

Aabb extent_of_boxes(const std::vector<Aabb>& boxes) {
  Aabb extent = Aabb::empty();
  for (const Aabb& box : boxes) extent = combine(extent, box);
  return extent;
}

/// Options with the automatic length of Morton keys, as for bodies with these boxes.
RunOptions with_key_bits_of_boxes(RunOptions options, const std::vector<Aabb>& boxes) {
  if (options.key_bits != 0) return options;
  InitialBodies bodies;
  for (const Aabb& box : boxes) {
    const Vector3d min = box.min.cast<double>(), max = box.max.cast<double>();
    bodies.position.push_back((min + max) / 2);
    bodies.radius.push_back(std::max((max - min).maxCoeff() / 2, 1e-30));
  }
  const Aabb extent = extent_of_boxes(boxes);
  bodies.box = Box{extent.min.cast<double>(), extent.max.cast<double>()};
  options.key_bits = automatic_key_bits(bodies, bodies.position, options.sort);
  return options;
}

constexpr std::int64_t most_listed_pairs = (std::int64_t{1} << 31) - 1;

}  // namespace

BoxQuery::BoxQuery(RunOptions options, const std::vector<Aabb>& boxes)
    : count_(std::ssize(boxes)),
      executor_(with_key_bits_of_boxes(options, boxes)),
      boxes_(executor_, "boxes"),
      extent_(executor_, "extent"),
      control_(executor_, "control"),
      pairs_(executor_),
      cache_(executor_, count_) {
  executor_.set_shapes(options.shape, options.stage_shapes);
  boxes_.upload(boxes);
  extent_.upload({extent_of_boxes(boxes)});
  control_.upload({StepControl{}});
  const std::int64_t first_capacity = std::max<std::int64_t>(1024, 4 * count_);
  pairs_.reserve(count_, first_capacity);
  const std::int64_t before = executor_.allocated_bytes();
  method_ = make_broad_phase(options.broad_phase, executor_);
  method_->reserve(count_);
  method_->reserve_pairs(first_capacity);
  method_bytes_ = executor_.allocated_bytes() - before;
}

void BoxQuery::enqueue() {
  method_->update(boxes_.data(), extent_.data());
  pairs_.find(*method_, control_.data());
}

BoxPairs BoxQuery::find() {
  StepControl control{};
  for (;;) {
    enqueue();
    control = control_.download()[0];
    if (!control.overflow) break;
    const auto needed = static_cast<std::int64_t>(control.pairs_needed);
    if (needed > most_listed_pairs)
      throw MachineError(std::to_string(needed) + " pairs of boxes; a list has at most " +
                         std::to_string(most_listed_pairs));
    pairs_.reserve(count_, needed);
    method_->reserve_pairs(needed);
    control_.upload({StepControl{}});
  }
  cache_.invalidate();
  BoxPairs pairs;
  pairs.offset.resize(static_cast<std::size_t>(count_) + 1);
  pairs.second.resize(control.pairs);
  executor_.copy_to_host(pairs.offset.data(), pairs_.view().offset,
                         pairs.offset.size() * sizeof(std::uint32_t));
  executor_.copy_to_host(pairs.second.data(), pairs_.view().second,
                         pairs.second.size() * sizeof(std::uint32_t));
  return pairs;
}

void BoxQuery::move(const std::vector<Aabb>& boxes) {
  boxes_.upload(boxes);
  extent_.upload({extent_of_boxes(boxes)});
  cache_.invalidate();
}

BroadPhaseTimes BoxQuery::time(int repeats) {
  return time_broad_phase(
      executor_, [this] { enqueue(); }, repeats);
}

PairDifference compare_pairs(const BoxPairs& expected, const BoxPairs& actual, std::size_t examples) {
  PairDifference difference;
  if (expected == actual) return difference;
  for (std::size_t a = 0; a + 1 < expected.offset.size(); ++a) {
    const auto list_of = [&](const BoxPairs& pairs) {
      return std::pair(pairs.second.begin() + pairs.offset[a], pairs.second.begin() + pairs.offset[a + 1]);
    };
    auto [wanted, last_wanted] = list_of(expected);
    auto [found, last_found] = list_of(actual);
    const auto note = [&](std::int64_t& count, auto& list, std::uint32_t b) {
      ++count;
      if (list.size() < examples) list.emplace_back(static_cast<std::uint32_t>(a), b);
    };
    while (wanted != last_wanted || found != last_found) {
      if (found == last_found || (wanted != last_wanted && *wanted < *found))
        note(difference.missing, difference.missing_examples, *wanted++);
      else if (wanted == last_wanted || *found < *wanted)
        note(difference.excess, difference.excess_examples, *found++);
      else
        ++wanted, ++found;
    }
  }
  return difference;
}

}  // namespace collidoscope
