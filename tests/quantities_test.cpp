// Tests each quantity of a criterion against a value computed by hand.

#include "sim_cuda/stability/quantities.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/run/run_state.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

class Quantities : public OnEachExecutor {
 protected:
  /// The extremes of an assertion after `change` is applied to the scene's first state.
  template <class Change>
  Extremes after(const Scene& scene, const Assertion& assertion, Change change) {
    World world(scene, options());
    Observation observation(world, std::vector<Assertion>{assertion});
    RunState state = world.state();
    change(state.bodies);
    world.restore(state);
    observation.update(world, scene.physics.time_step);
    offending_body_ = offending_body(assertion, observation);
    return measured(assertion, observation);
  }
  Extremes at_once(const Scene& scene, const Assertion& assertion) {
    return after(scene, assertion, [](BodyStates&) {});
  }
  std::optional<std::uint32_t> offending_body_;
};
ON_EACH_EXECUTOR(Quantities);

Assertion term_of(Quantity quantity) {
  Assertion assertion;
  assertion.quantity = quantity;
  return assertion;
}

/// Three bodies of 1 m and 1 kg. Two overlap by 0.5 m. One is 0.25 m deep in the floor and rotates.
Scene three() {
  Scene scene = hard_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 5), Vector3d(1, 0, 0)), sphere(1, Vector3d(1.5, 0, 5)),
                  sphere(1, Vector3d(8, 0, 0.75), Vector3d(0, 2, 0))};
  for (Body& body : scene.bodies) body.mass = 1;
  scene.bodies[2].angular_velocity = Vector3d(0, 0, 3);
  scene.box = Box{Vector3d(-10, -10, 0), Vector3d(10, 10, 10)};
  scene.physics.gravity = Vector3d(0, 0, -10);
  return scene;
}

TEST_P(Quantities, AreWhatTheyAreByHand) {
  const Scene scene = three();
  const auto most = [&](Quantity quantity) { return at_once(scene, term_of(quantity)).max; };
  EXPECT_EQ(most(Quantity::finite), 0);
  EXPECT_DOUBLE_EQ(most(Quantity::penetration), 0.5);
  EXPECT_EQ(offending_body_, 0u);
  EXPECT_DOUBLE_EQ(most(Quantity::penetration_over_radius), 0.5);
  EXPECT_DOUBLE_EQ(most(Quantity::speed), 2);
  EXPECT_DOUBLE_EQ(most(Quantity::angular_speed), 3);
  EXPECT_EQ(most(Quantity::energy_gain), 0);
  EXPECT_DOUBLE_EQ(most(Quantity::kinetic_energy), 0.5 + 2 + 0.4 * 9 / 2);
  EXPECT_EQ(most(Quantity::escaped), 0);
  EXPECT_EQ(most(Quantity::displacement), 0);
  EXPECT_EQ(most(Quantity::quaternion_norm), 0);
  EXPECT_EQ(most(Quantity::pairs), 1);
  EXPECT_EQ(most(Quantity::touching), 1);
  EXPECT_EQ(most(Quantity::speculative), 1);
  EXPECT_EQ(most(Quantity::asleep), 0);
  EXPECT_EQ(most(Quantity::joint_error), 0);
  EXPECT_EQ(most(Quantity::tree_depth), 3);
  EXPECT_DOUBLE_EQ(most(Quantity::separation_speed), -1) << "they approach";
}

TEST_P(Quantities, OfOneBodyOrAllAlongAnAxis) {
  Assertion assertion = term_of(Quantity::position);
  assertion.axis = 2;
  const Extremes all = at_once(three(), assertion);
  EXPECT_DOUBLE_EQ(all.min, 0.75);
  EXPECT_EQ(all.min_body, 2u);
  EXPECT_DOUBLE_EQ(all.max, 5);
  assertion.body = 1;
  EXPECT_DOUBLE_EQ(at_once(three(), assertion).min, 5);
  assertion.body = 7;
  EXPECT_TRUE(std::isnan(at_once(three(), assertion).max)) << "there is no such body";
  assertion = term_of(Quantity::velocity);
  assertion.axis = 1;
  EXPECT_DOUBLE_EQ(at_once(three(), assertion).max, 2);
}

TEST_P(Quantities, FindWhoIsToBlame) {
  const auto lose = [](BodyStates& bodies) { bodies.velocity[1] = Vector3d(0, none, 0); };
  EXPECT_EQ(after(three(), term_of(Quantity::finite), lose).max, 1);
  EXPECT_EQ(offending_body_, 1u);
  EXPECT_TRUE(std::isnan(after(three(), term_of(Quantity::speed), lose).max));
  const auto leave = [](BodyStates& bodies) { bodies.position[2] = Vector3d(11, 0, 1); };
  EXPECT_EQ(after(three(), term_of(Quantity::escaped), leave).max, 1);
  EXPECT_EQ(offending_body_, 2u);
  const auto sink = [](BodyStates& bodies) { bodies.position[2] = Vector3d(8, 0, 0.125); };
  EXPECT_DOUBLE_EQ(after(three(), term_of(Quantity::penetration), sink).max, 0.875);
  EXPECT_EQ(offending_body_, 2u);
}

TEST_P(Quantities, CompareWithTheStart) {
  const auto push = [](BodyStates& bodies) {
    bodies.position[1] += Vector3d(0, 0.5, 0);
    bodies.velocity[1] = Vector3d(0, 1, 0);
  };
  EXPECT_DOUBLE_EQ(after(three(), term_of(Quantity::displacement), push).max, 0.5);
  // 0.5 J more. The scale is 4.8 J, the largest energy so far.
  EXPECT_DOUBLE_EQ(after(three(), term_of(Quantity::energy_gain), push).max, 0.5 / 4.8);
  EXPECT_DOUBLE_EQ(after(three(), term_of(Quantity::energy_loss), push).max, -0.5 / 4.8);
  // Without gravity the expected change is 0. Body 1 has 1 kg m/s more, relative to its mean momentum.
  Scene floating = three();
  floating.physics.gravity = Vector3d(0, 0, 0);
  const double mean = 0.5 / three().physics.time_step;
  EXPECT_DOUBLE_EQ(after(floating, term_of(Quantity::momentum_change), push).max, 1.0 / mean);
  const double owed = 3 * 10 * three().physics.time_step;
  EXPECT_DOUBLE_EQ(after(three(), term_of(Quantity::momentum_change), push).max, std::hypot(1, owed) / mean);
  const auto turn = [](BodyStates& bodies) { bodies.angular_velocity[0] = Vector3d(0, 5, 0); };
  Scene spinning = hard_space();
  spinning.bodies = {sphere(1, Vector3d(0, 0, 0))};
  spinning.bodies[0].mass = 1;
  spinning.bodies[0].angular_velocity = Vector3d(0, 4, 0);
  EXPECT_DOUBLE_EQ(after(spinning, term_of(Quantity::angular_momentum_change), turn).max, 0.2);
}

TEST_P(Quantities, KnowWhatCannotTouch) {
  Scene scene = hard_space();
  scene.bodies = {sphere(1, Vector3d(0, 0, 0)), sphere(1, Vector3d(1, 0, 0)), sphere(1, Vector3d(9, 0, 0)),
                  sphere(1, Vector3d(9.5, 0, 0))};
  scene.bodies[2].motion = scene.bodies[3].motion = Motion::fixed;
  Joint rod;
  rod.a = 1;
  rod.b = 0;
  scene.joints = {rod};
  EXPECT_EQ(at_once(scene, term_of(Quantity::penetration_over_radius)).max, 0);
  scene.joints[0].collide = true;
  EXPECT_EQ(at_once(scene, term_of(Quantity::penetration_over_radius)).max, 1);
}

TEST(Extremes, OfNothingAreNothingAndNanStays) {
  Extremes extremes;
  EXPECT_EQ(extremes.max, 0);
  extremes.add(2, 0);
  extremes.add(-1, 1);
  extremes.add(5, 2);
  EXPECT_EQ(extremes.min, -1);
  EXPECT_EQ(extremes.min_body, 1u);
  EXPECT_EQ(extremes.max, 5);
  EXPECT_EQ(extremes.max_body, 2u);
  extremes.add(none, 3);
  extremes.add(7, 4);
  EXPECT_TRUE(std::isnan(extremes.min) && std::isnan(extremes.max));
  EXPECT_EQ(extremes.max_body, 3u);
}

TEST(Difference, IsOfTheSameBodiesMovedByAnOffset) {
  Assertion assertion = term_of(Quantity::difference);
  assertion.offset = Vector3d(100, 0, 0);
  BodyStates here, there;
  there.position = {Vector3d(0, 0, 0), Vector3d(1, 0, 0)};
  here.position = {Vector3d(100, 0, 0), Vector3d(101, 0.25, 0)};
  EXPECT_EQ(difference(assertion, here, there).max, 0.25);
  EXPECT_EQ(difference(assertion, here, there).max_body, 1u);
  there.position.pop_back();
  EXPECT_TRUE(std::isnan(difference(assertion, here, there).max)) << "other bodies";
}

}  // namespace
}  // namespace collidoscope
