// Tests the automatic choice of the Morton key length against scenes for which short or long keys are right.
#include "sim_cuda/broad_phase/key_bits.h"

#include <gtest/gtest.h>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

/// The bodies of the Box Collider with 30 % filling, in a box `times` as wide.
Scene in_a_larger_box(std::int64_t count, double times) {
  const InitialBodies bodies = initial_bodies(box_collider(count, Variant::scaled));
  Scene scene = empty_space();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    scene.bodies.push_back(sphere(bodies.radius[i], bodies.position[i]));
  scene.box = Box{bodies.box->min, bodies.box->min + times * (bodies.box->max - bodies.box->min)};
  return scene;
}

int required(const Scene& scene) { return automatic_key_bits(initial_bodies(scene)); }

TEST(KeyBits, AreShortInEveryBoxCollider) {
  for (const Variant variant : {Variant::paper, Variant::scaled, Variant::equal})
    for (const std::int64_t count : {0, 1, 129, 2'000, 50'000})
      EXPECT_EQ(required(box_collider(count, variant)), 30) << count;
}

TEST(KeyBits, AreLongWhereAHeapWouldFillACell) {
  EXPECT_EQ(required(in_a_larger_box(2000, 1.3)), 30) << "14 % of the box is full";
  EXPECT_EQ(required(in_a_larger_box(2000, 3.1)), 63);
  EXPECT_EQ(required(in_a_larger_box(2000, 100)), 63);
  EXPECT_EQ(required(in_a_larger_box(128, 100)), 30) << "all of them are no crowd";
}

TEST(KeyBits, AreLongWhereAMinorityOfSmallBodiesCouldGather) {
  for (const int small : {0, 50, 1180, 2900}) {
    Scene scene = empty_space();
    scene.box = Box{Vector3d(0, 0, 0), Vector3d(60, 60, 60)};
    for (int i = 0; i < 5900; ++i)
      scene.bodies.push_back(sphere(i < small ? 0.0005 : 0.5,
                                    Vector3d(1 + 3 * (i % 20), 1 + 3 * (i / 20 % 20), 1 + 3 * (i / 400))));
    EXPECT_EQ(required(scene), small < 1180 ? 30 : 63) << small;
  }
}

TEST(KeyBits, AreLongWhereNothingBoundsTheExtent) {
  Scene scene = in_a_larger_box(2000, 1);
  scene.box.reset();
  EXPECT_EQ(required(scene), 63);
  scene.bodies.resize(128);
  EXPECT_EQ(required(scene), 30);
}

class KeyBitsOfAWorld : public OnEachExecutor {
 protected:
  World world(const Scene& scene, int bits) const {
    RunOptions o = options();
    o.key_bits = bits;
    return World(scene, o);
  }
};
ON_EACH_EXECUTOR(KeyBitsOfAWorld);

TEST_P(KeyBitsOfAWorld, KeepACrowdsTreeAsGoodAsInABoxOfItsOwn) {
  const double good = world(in_a_larger_box(3000, 1), 0).tree().quality().visits_mean;
  Scene stray = in_a_larger_box(3000, 1);
  stray.box.reset();
  stray.bodies.push_back(sphere(1, Vector3d(1e6, 1e6, 1e6)));
  for (const Scene& scene : {in_a_larger_box(3000, 1000), stray}) {
    World automatic = world(scene, 0), crowded = world(scene, 30);
    EXPECT_EQ(automatic.info().key_bits, 63);
    EXPECT_EQ(crowded.info().key_bits, 30);
    EXPECT_LT(automatic.tree().quality().visits_mean, 1.3 * good);
    EXPECT_GT(crowded.tree().quality().visits_mean, 10 * good);
    for (World* w : {&automatic, &crowded}) w->step(5);
    EXPECT_EQ(automatic.state_hash(), crowded.state_hash());
    EXPECT_EQ(automatic.measure().pairs, crowded.measure().pairs);
  }
}

TEST_P(KeyBitsOfAWorld, AreOfTheMethodsThatHaveKeysAndDecidedAnewForOtherBodies) {
  RunOptions o = options();
  World tree(in_a_larger_box(500, 100), o);
  EXPECT_EQ(tree.info().key_bits, 63);
  EXPECT_EQ(tree.options().key_bits, 0) << "as asked for, so that a world made of it decides again";
  o.broad_phase = "uniform_grid";
  EXPECT_EQ(World(in_a_larger_box(500, 100), o).info().key_bits, 0);
}

}  // namespace
}  // namespace collidoscope
