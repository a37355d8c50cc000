// Tests every broad phase of a World against brute force, on random and adversarial scenes. A missed pair
// would be a missed collision.
#include "sim_cuda/broad_phase/broad_phase.h"

#include <algorithm>

#include "sim_cuda/core/error.h"
#include "sim_cuda/dynamics/bounds.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using PairIds = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// All pairs of bodies whose float boxes overlap, by brute force.
template <class Real>
PairIds by_definition(World& world) {
  const BodyStates states = world.bodies();
  const std::size_t n = states.position.size();
  std::vector<Vector3<Real>> position(n);
  std::vector<Real> radius(n);
  std::vector<Aabb> boxes(n);
  for (std::size_t i = 0; i < n; ++i) {
    position[i] = states.position[i].cast<Real>();
    radius[i] = static_cast<Real>(world.initial().radius[i]);
  }
  const BodyBounds<Real> bounds{position.data(), radius.data(), boxes.data()};
  for (std::size_t i = 0; i < n; ++i) bounds(static_cast<int>(i));
  PairIds pairs;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j)
      if (overlap(boxes[i], boxes[j])) pairs.emplace_back(i, j);
  return pairs;
}

class BroadPhases : public OnEachExecutor {
 protected:
  void expect_all_pairs(const Scene& scene) {
    for (const std::string& method : broad_phase_names(GetParam()))
      for (const int bits : {24, 30, 63}) {
        RunOptions o = options();
        o.broad_phase = method;
        o.key_bits = bits;
        World world(scene, o);
        world.detect();
        const PairIds expected = scene.physics.precision == Precision::f64 ? by_definition<double>(world)
                                                                           : by_definition<float>(world);
        ASSERT_EQ(world.pairs(), expected)
            << method << ", " << bits << " bits, " << scene.bodies.size() << " bodies";
        ASSERT_EQ(world.measure().pairs, static_cast<std::int64_t>(expected.size()));
      }
  }
};
ON_EACH_EXECUTOR(BroadPhases);

TEST_P(BroadPhases, FindAllPairsOf40RandomScenes) {  // broad_phase_boxes_test.cpp has a thousand more
  for (unsigned seed = 0; seed < 40; ++seed) {
    Scene scene = random_scene(seed, 120);
    if (seed % 2) scene.physics.precision = Precision::f64;
    expect_all_pairs(scene);
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

TEST_P(BroadPhases, FindAllPairsOfAdversarialScenes) {
  for (const int count : {0, 1, 2, 3, 15, 16, 17, 33}) {  // a CPU walks for 16 bodies at a time
    Scene few = empty_space();
    for (int i = 0; i < count; ++i) few.bodies.push_back(sphere(1, Vector3d(0.5 * i, 0, 0)));
    expect_all_pairs(few);
  }

  Scene coincident = empty_space();
  for (int i = 0; i < 150; ++i) coincident.bodies.push_back(sphere(0.5 + i % 3, Vector3d(1, 2, 3)));
  expect_all_pairs(coincident);

  Scene line = empty_space();
  for (int i = 0; i < 300; ++i)
    line.bodies.push_back(sphere(0.5, Vector3d(i, 0, 0)));  // neighbours touch exactly
  expect_all_pairs(line);
  for (Body& body : line.bodies)
    body.position = Vector3d(body.position.x(), body.position.x(), body.position.x());
  expect_all_pairs(line);

  Scene giant = empty_space();
  for (int i = 0; i < 400; ++i)
    giant.bodies.push_back(sphere(i == 200 ? 100 : 0.01, Vector3d(i % 20, i / 20 % 20, 0.1 * (i % 7))));
  expect_all_pairs(giant);

  Scene outlier = empty_space();  // all but one body in one Morton cell
  for (int i = 0; i < 200; ++i) outlier.bodies.push_back(sphere(0.3, Vector3d(0.1 * i, 0, 0)));
  outlier.bodies.push_back(sphere(1, Vector3d(1e6, 1e6, 1e6)));
  expect_all_pairs(outlier);
}

TEST_P(BroadPhases, TreesHoldTheirBodies) {
  for (const std::string& method : broad_phase_names(GetParam()))
    for (const std::int64_t count : {1, 2, 777}) {
      RunOptions o = options();
      o.broad_phase = method;
      World world(box_collider(count), o);
      const TreeLevels tree = world.tree().levels();
      std::int64_t nodes = 0;
      for (const auto& level : tree.levels) nodes += std::ssize(level);
      ASSERT_EQ(nodes, world.tree().nodes()) << method;
      if (nodes == 0) continue;
      EXPECT_GE(nodes, count) << method;
      ASSERT_EQ(tree.levels.front().size(), 1u) << method;
      // On the path from each body to the root, every box contains the one below it.
      for (std::uint32_t id = 0; id < count; ++id) {
        const BodyReport body = world.inspect(id);
        ASSERT_FALSE(body.path.empty()) << method << ", body " << id;
        const TreeLevels::Box &leaf = body.path.front(), &root = body.path.back();
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double x = body.X[static_cast<int>(axis)];
          EXPECT_NEAR(leaf.min[axis], x - body.radius, 1e-4) << method;
          EXPECT_NEAR(leaf.max[axis], x + body.radius, 1e-4) << method;
          EXPECT_EQ(root.min[axis], tree.levels[0][0].min[axis]) << method;
          for (std::size_t k = 1; k < body.path.size(); ++k) {
            EXPECT_LE(body.path[k].min[axis], body.path[k - 1].min[axis]) << method;
            EXPECT_GE(body.path[k].max[axis], body.path[k - 1].max[axis]) << method;
          }
        }
      }
    }
}

TEST_P(BroadPhases, WhatNeedsTheCpuIsRefusedElsewhere) {
  const std::vector<std::string> here = broad_phase_names(GetParam());
  for (const std::string& method : broad_phase_names()) {
    RunOptions o = options();
    o.broad_phase = method;
    if (std::find(here.begin(), here.end(), method) != here.end()) {
      EXPECT_NO_THROW(World(box_collider(10), o)) << method;
    } else {
      EXPECT_EQ(method, "bullet_dbvt");
      EXPECT_EQ(GetParam(), ExecutorKind::cuda);
      EXPECT_THROW(World(box_collider(10), o), MachineError);
    }
  }
}

TEST(BroadPhase, UnknownNamesListTheKnown) {
  RunOptions o;
  o.executor = ExecutorKind::cpu;
  o.broad_phase = "bvh_botom_up";
  try {
    World world(box_collider(10), o);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string line = error.what();
    EXPECT_TRUE(line.starts_with("unknown broad phase 'bvh_botom_up'; expected one of lbvh_ropes, ")) << line;
    for (const std::string& name : broad_phase_names()) EXPECT_NE(line.find(name), line.npos) << name;
  }
}

}  // namespace
}  // namespace collidoscope
