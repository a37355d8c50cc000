// Tests every broad phase against the definition of an overlapping pair, on explicit boxes. The boxes cover
// cases that scenes rarely contain, at many launch shapes.

#include <algorithm>
#include <cmath>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/pair_list.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "tests/executors.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

using PairIds = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

class BroadPhaseBoxes : public OnEachExecutor {
 protected:
  /// One set of run options, with all methods on their own executor.
  struct Runner {
    explicit Runner(const RunOptions& options)
        : executor(options),
          boxes(executor, "boxes"),
          extent(executor, "extent"),
          control(executor, "control"),
          list(executor),
          names(broad_phase_names(options.executor)) {
      for (const std::string& name : names) methods.push_back(make_broad_phase(name, executor));
    }
    void start(BroadPhase& method, std::size_t bodies, std::size_t pairs) {
      control.upload({StepControl{}});
      list.reserve(static_cast<std::int64_t>(bodies), static_cast<std::int64_t>(pairs) + 1);
      method.reserve(static_cast<std::int64_t>(bodies));
    }
    /// Returns the pairs after an update to these boxes.
    PairIds pairs_of(BroadPhase& method, const std::vector<Aabb>& host_boxes, const Aabb& host_extent) {
      boxes.upload(host_boxes);
      extent.upload({host_extent});
      method.update(boxes.data(), extent.data());
      list.find(method, control.data());
      return read(host_boxes.size());
    }
    PairIds find(BroadPhase& method, const std::vector<Aabb>& host_boxes, const Aabb& host_extent,
                 std::size_t pairs) {
      start(method, host_boxes.size(), pairs);
      PairIds first = pairs_of(method, host_boxes, host_extent);
      EXPECT_EQ(pairs_of(method, host_boxes, host_extent),
                first);  // an update has no influence on the next one
      return first;
    }
    PairIds read(std::size_t bodies) {
      const StepControl c = control.download()[0];
      EXPECT_EQ(c.overflow, 0u) << c.pairs_needed << " pairs";
      std::vector<std::remove_cv_t<std::remove_pointer_t<decltype(list.view().offset)>>> offset(bodies + 1);
      std::vector<std::uint32_t> second(c.pairs);
      executor.copy_to_host(offset.data(), list.view().offset, offset.size() * sizeof offset[0]);
      executor.copy_to_host(second.data(), list.view().second, second.size() * sizeof second[0]);
      PairIds ids;
      for (std::uint32_t a = 0; a < bodies; ++a)
        for (std::uint64_t k = offset[a]; k < offset[a + 1]; ++k) ids.emplace_back(a, second[k]);
      return ids;
    }
    Executor executor;
    Buffer<Aabb> boxes, extent;
    Buffer<StepControl> control;
    PairList list;
    std::vector<std::string> names;
    std::vector<std::unique_ptr<BroadPhase>> methods;
  };

  BroadPhaseBoxes() {
    const auto add = [this](int bits, LaunchShape shape, LaneOrder order) {
      RunOptions o = options();
      o.key_bits = bits;
      o.shape = shape;
      o.lane_order = order;
      runners_.push_back(std::make_unique<Runner>(o));
    };
    add(30, {}, LaneOrder::contiguous);
    add(63, {3, 37}, LaneOrder::shuffled);
    add(30, {16, 16}, LaneOrder::strided);
    add(30, {2, 1}, LaneOrder::shuffled);
  }

  /// Checks that all methods, run with the options number `how`, find exactly the pairs of the definition.
  void expect_all_pairs(const std::vector<Aabb>& boxes, const Aabb& extent, std::size_t how) {
    const PairIds expected = by_definition(boxes);
    Runner& runner = *runners_[how % runners_.size()];
    for (std::size_t k = 0; k < runner.names.size(); ++k)
      ASSERT_EQ(runner.find(*runner.methods[k], boxes, extent, expected.size()), expected)
          << runner.names[k] << " of " << boxes.size() << " boxes, run " << how % runners_.size();
  }
  void expect_all_pairs(const std::vector<Aabb>& boxes) {
    for (std::size_t how = 0; how < runners_.size(); ++how) expect_all_pairs(boxes, around(boxes), how);
  }

  static PairIds by_definition(const std::vector<Aabb>& boxes) {
    PairIds pairs;
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
      for (std::uint32_t j = i + 1; j < boxes.size(); ++j)
        if (overlap(boxes[i], boxes[j])) pairs.emplace_back(i, j);
    return pairs;
  }
  static Aabb around(const std::vector<Aabb>& boxes) {
    Aabb extent = Aabb::empty();
    for (const Aabb& box : boxes) extent = combine(extent, box);
    return extent;
  }
  static Aabb cube(float x, float y, float z, float radius) {
    return {Vector3f(x - radius, y - radius, z - radius), Vector3f(x + radius, y + radius, z + radius)};
  }

  std::vector<std::unique_ptr<Runner>> runners_;
};
ON_EACH_EXECUTOR(BroadPhaseBoxes);

/// Up to 150 boxes of random spread, shape and mix of sizes. Some coincide, some are empty.
std::vector<Aabb> random_boxes(unsigned seed) {
  Random random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  const auto power = [&](double low, double high) { return std::pow(10, uniform(low, high)); };
  const std::size_t count = random() % 150;
  const double spread = power(-3, 6);  // m
  const double far = random() % 4 == 0 ? power(0, 7) : 0;
  const unsigned flat = random() % 8, sizes = random() % 5;
  const bool on_a_lattice = random() % 4 == 0, some_empty = random() % 4 == 0;
  const double usual = spread * power(-3, 0);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    double radius = usual;
    if (sizes == 1) radius *= 1 - uniform(0, 1);
    if (sizes == 2) radius = power(-7, 6);
    if (sizes == 3) radius *= random() % 50 == 0 ? 1000 : 0.01;
    if (sizes == 4) radius *= power(-3, 0);
    Vector3f low, high;
    for (int k = 0; k < 3; ++k) {
      double x = flat >> k & 1 ? 0 : uniform(-spread, spread);
      if (on_a_lattice) x = std::floor(x / usual) * usual;  // faces that touch
      low[k] = static_cast<float>(far + x - radius);
      high[k] = static_cast<float>(far + x + radius);
    }
    if (i > 0 && random() % 16 == 0)
      boxes.push_back(boxes[random() % i]);
    else
      boxes.push_back(some_empty && random() % 8 == 0 ? Aabb::empty() : Aabb{low, high});
  }
  return boxes;
}

TEST_P(BroadPhaseBoxes, PairsOf1000RandomScenes) {
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const std::vector<Aabb> boxes = random_boxes(seed);
    Aabb extent = around(boxes);  // also a wrong extent: it may cost time but must lose no pair
    if (seed % 8 == 1) extent = cube(0, 0, 0, 50);
    if (seed % 8 == 3) extent = cube(1e7f, 3, -1e-3f, 1e-3f);
    if (seed % 8 == 5) extent = Aabb::empty();
    expect_all_pairs(boxes, extent, seed);
    if (HasFailure()) FAIL() << "seed " << seed;
  }
}

/// Methods keep data between updates. Bodies creep, jump, vanish and come back.
TEST_P(BroadPhaseBoxes, PairsAfterAnyMotion) {
  constexpr std::size_t count = 120;
  for (std::size_t how = 0; how < runners_.size(); ++how) {
    Runner& runner = *runners_[how];
    for (const auto& method : runner.methods) {
      Random random(3);
      const auto uniform = [&](float high) { return high * static_cast<float>(random() / 4294967296.0); };
      std::vector<Aabb> boxes(count, Aabb::empty());
      for (Aabb& box : boxes) box = cube(uniform(10), uniform(10), uniform(10), uniform(1));
      runner.start(*method, count, count * count);
      for (int move = 0; move < 40; ++move) {
        for (Aabb& box : boxes) {
          const bool leaps = move % 10 == 9 || random() % 50 == 0;
          if (leaps || is_empty(box)) box = cube(uniform(10), uniform(10), uniform(10), uniform(1));
          if (move == 30) box = cube(1e6f * uniform(1), 0, 0, 1e-3f);
          if (random() % 20 == 0) box = Aabb::empty();
          if (is_empty(box)) continue;
          const Vector3f step(uniform(0.1f), -uniform(0.1f), uniform(0.1f));
          box.min += step;
          box.max += step;
        }
        ASSERT_EQ(runner.pairs_of(*method, boxes, around(boxes)), by_definition(boxes))
            << runner.names[static_cast<std::size_t>(&method - runner.methods.data())] << ", move " << move
            << ", run " << how;
      }
    }
  }
}

TEST_P(BroadPhaseBoxes, PairsOfFewBodies) {
  for (int count = 0; count <= 3; ++count) {
    std::vector<Aabb> boxes;
    for (int i = 0; i < count; ++i)
      boxes.push_back(cube(static_cast<float>(2 * i), 0, 0, 1));  // one face touches
    expect_all_pairs(boxes);
  }
}

TEST_P(BroadPhaseBoxes, PairsOfCoincidentBodies) {
  expect_all_pairs(std::vector<Aabb>(300, cube(1, 2, 3, 0.5f)));
  expect_all_pairs(std::vector<Aabb>(300, cube(1e6f, 2, 3, 0)));  // degenerate boxes: one point each
  std::vector<Aabb> nested;
  for (int i = 0; i < 100; ++i) nested.push_back(cube(1, 1, 1, std::exp2(static_cast<float>(i - 50))));
  expect_all_pairs(nested);
}

TEST_P(BroadPhaseBoxes, PairsOfBoxesThatTouchExactly) {
  std::vector<Aabb> line, plane, block, gaps;
  for (int i = 0; i < 343; ++i) {
    const int row = i / 7 % 7, layer = i / 49, row_of_19 = i / 19;
    const auto x = static_cast<float>(i % 7), y = static_cast<float>(row), z = static_cast<float>(layer);
    line.push_back(cube(static_cast<float>(i), 5, 5, 0.5f));
    plane.push_back(cube(static_cast<float>(i % 19), static_cast<float>(row_of_19), 0, 0.5f));
    block.push_back(cube(x, y, z, 0.5f));
    gaps.push_back(cube(
        x, y, z, 0.49999997f));  // the next float below: the boxes touch where rounding loses the difference
  }
  for (const auto& boxes : {line, plane, block, gaps}) expect_all_pairs(boxes);
}

TEST_P(BroadPhaseBoxes, PairsOfOneHugeBodyAmongDust) {
  std::vector<Aabb> dust;
  Random random(7);
  const auto coordinate = [&] { return static_cast<float>(random() % 100000) * 1e-3f; };
  for (int i = 0; i < 500; ++i) {
    const float x = coordinate(), y = coordinate(), z = coordinate();
    dust.push_back(i == 250 ? cube(50, 50, 50, 60) : cube(x, y, z, i % 3 == 0 ? 1e-4f : 1.0f));
  }
  expect_all_pairs(dust);
  dust[100] = cube(0, 0, 0, 1e6f);
  dust[400] = cube(1e6f, 0, 0, 1e6f);
  expect_all_pairs(dust);
}

TEST_P(BroadPhaseBoxes, PairsBesideAnOutlier) {
  std::vector<Aabb> boxes;  // all but one have the same Morton key of 30 bits
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x)
      boxes.push_back(
          cube(static_cast<float>(x), static_cast<float>(y), 0.01f * static_cast<float>((x + y) % 7), 0.6f));
  boxes.push_back(cube(1e6f, 1e6f, 1e6f, 1));
  expect_all_pairs(boxes);
}

TEST_P(BroadPhaseBoxes, PairsOfRadiiFromDustToPlanets) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 400; ++i) {
    const auto k = static_cast<float>(i);
    const float radius = 1e-7f * std::exp2(k / 400 * 43.2f);  // up to 10^6 m
    boxes.push_back(cube(radius * 1.5f, static_cast<float>(i % 3) * radius, -k, radius));
  }
  expect_all_pairs(boxes);
}

TEST_P(BroadPhaseBoxes, PairsAtTheEdgeOfTheNumbers) {
  constexpr float huge = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
  std::vector<Aabb> boxes;
  for (const float x : {0.0f, -0.0f, 1.0f, -1.0f, huge, -huge, huge / 2, tiny, -tiny, 1e-38f, 1e38f})
    for (const float side : {0.0f, tiny, 1e-38f, 1.0f, huge / 2, huge}) {
      const auto clamped = [](double v) {
        return static_cast<float>(std::clamp(v, -double{huge}, double{huge}));
      };
      const float high = clamped(double{x} + double{side});
      boxes.push_back({Vector3f(x, x, x), Vector3f(high, high, high)});
      boxes.push_back({Vector3f(x, 0, x), Vector3f(high, 0, high)});
    }
  boxes.insert(boxes.begin() + 7, 5, Aabb::empty());
  expect_all_pairs(boxes);
  expect_all_pairs(std::vector<Aabb>(20, Aabb::empty()));
}

/// The number of bodies exceeds every block size, batch and table of the methods.
TEST_P(BroadPhaseBoxes, PairsOfManyBodies) {
  std::vector<Aabb> boxes;
  Random random(11);
  const auto uniform = [&](double high) { return static_cast<float>(high * (random() / 4294967296.0)); };
  for (int i = 0; i < 6000; ++i) {
    const float x = uniform(100), y = uniform(100), z = uniform(10);
    boxes.push_back(cube(x, y, z, i % 1000 == 0 ? 10 : 0.01f + uniform(i % 4 == 0 ? 1 : 0.1)));
  }
  expect_all_pairs(boxes, around(boxes), 0);
  expect_all_pairs(boxes, cube(50, 50, 5, 10), 2);
}

TEST_P(BroadPhaseBoxes, PairsOfSoManyBodiesThatBruteForceIsLeftOut) {
  std::vector<Aabb> boxes;
  Random random(12);
  const auto uniform = [&](double high) { return static_cast<float>(high * (random() / 4294967296.0)); };
  for (int i = 0; i < 150000; ++i) {
    const float x = uniform(300), y = uniform(300), z = uniform(30);
    boxes.push_back(cube(x, y, z, i == 140000 ? 5.0f : 0.1f + uniform(1)));
  }
  Runner& runner = *runners_[0];
  const std::vector<std::string>& names = runner.names;
  PairIds expected;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k].starts_with("brute_force") || names[k] == "bvh_input_order") continue;  // 10^10 tests
    const PairIds found = runner.find(*runner.methods[k], boxes, around(boxes), 4 * boxes.size());
    if (expected.empty()) expected = found;
    EXPECT_GT(found.size(), boxes.size() / 4);
    EXPECT_TRUE(found == expected) << names[k] << ": " << found.size() << " pairs, " << expected.size();
  }
}

}  // namespace
}  // namespace collidoscope
