// Tests the break conditions of a run: parsing of the list, the state at which each is met, and the body that
// is reported.

#include "sim_cuda/run/break_conditions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "sim_cuda/core/error.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/stability/offending_body.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

std::string fault_of(const std::string& list) {
  try {
    parse_break_conditions(list);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(BreakConditions, AreReadFromAList) {
  BreakConditions all =
      parse_break_conditions("non-finite,energy-rise=5,penetration=0.1,speed=100,stage-ms=20,escaped");
  EXPECT_EQ(all.limit(BreakCondition::non_finite), 0.0);
  EXPECT_EQ(all.limit(BreakCondition::energy_rise), 5.0);
  EXPECT_EQ(all.limit(BreakCondition::penetration), 0.1);
  EXPECT_EQ(all.limit(BreakCondition::speed), 100.0);
  EXPECT_EQ(all.limit(BreakCondition::stage_ms), 20.0);
  EXPECT_EQ(all.limit(BreakCondition::escaped), 0.0);
  BreakConditions one = parse_break_conditions("speed=0");
  EXPECT_TRUE(one.any());
  EXPECT_EQ(one.limit(BreakCondition::speed), 0.0);
  EXPECT_FALSE(one.limit(BreakCondition::escaped));
  EXPECT_FALSE(BreakConditions{}.any());
}

TEST(BreakConditions, SayWhatWouldBeRight) {
  EXPECT_EQ(
      fault_of("sped=3"),
      "--break: 'sped=3' is not a condition; expected a list of non-finite, energy-rise=%, penetration=m, "
      "speed=m/s, stage-ms=ms, escaped");
  EXPECT_THAT(fault_of(""), HasSubstr("'' is not a condition"));
  EXPECT_THAT(fault_of("speed"), HasSubstr("'speed': expected speed=m/s, a number from 0 to 1e+18"));
  for (const char* bad : {"speed=", "speed=nan", "speed=-1", "speed=1e30", "speed=3x", "speed=inf"})
    EXPECT_THAT(fault_of(bad), HasSubstr("speed=m/s, a number from 0")) << bad;
  EXPECT_EQ(fault_of("escaped=1"), "--break: 'escaped=1': escaped takes no number");
  EXPECT_EQ(fault_of("escaped,escaped"), "--break: escaped is given twice; give it once");
}

/// A healthy state after a step: at rest 2 m below the start.
StepStats well() {
  StepStats stats;
  stats.step = 4;
  stats.kinetic_energy = 20;
  stats.potential_energy = 80;
  stats.max_penetration = 0.1;
  stats.max_speed = 5;
  return stats;
}
StepStats start() {
  StepStats stats;
  stats.potential_energy = 100;
  return stats;
}
RunTimes times() {
  RunTimes times;
  times.stages = {{.name = "bounds", .last_ms = 1}, {.name = "solve", .last_ms = 3}};
  return times;
}

std::optional<BreakpointHit> looked(const char* list, const StepStats& stats) {
  BreakpointMonitor watch(start());
  return watch.check(parse_break_conditions(list), stats, times());
}

TEST(BreakConditions, AreMetAboveTheirLimitAlone) {
  StepStats stats = well();
  for (const char* list :
       {"non-finite", "escaped", "penetration=0.1", "speed=5", "stage-ms=3", "energy-rise=0"})
    EXPECT_FALSE(looked(list, stats)) << list;
  for (const char* list : {"penetration=0.0999", "speed=4.99", "stage-ms=2.9"})
    EXPECT_TRUE(looked(list, stats)) << list;
  const BreakpointHit slow = *looked("stage-ms=2.9", stats);
  EXPECT_EQ(slow.stage, "solve");
  EXPECT_EQ(describe(slow), "stage-ms: stage solve of step 4 took 3 ms, over 2.9 ms");
  stats.step = 5;  // stages of this step were not timed
  EXPECT_FALSE(looked("stage-ms=2.9", stats));

  stats.non_finite = 2;
  stats.escaped = 3;
  EXPECT_EQ(looked("escaped,non-finite", stats)->condition, BreakCondition::non_finite)
      << "in their own order";
  EXPECT_EQ(describe(*looked("escaped", stats)), "escaped: after step 5 3 bodies");
  stats.max_speed = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(looked("speed=1e18", stats)) << "what is not a number is above every limit";
}

TEST(BreakConditions, MeasureEnergyAgainstWhatThereWasToMove) {
  BreakpointMonitor watch(start());
  const BreakConditions five = parse_break_conditions("energy-rise=5");
  StepStats stats = well();  // 20 J kinetic energy gained, 20 J potential energy lost: the scale is 40 J
  stats.kinetic_energy = 21.9;
  EXPECT_FALSE(watch.check(five, stats, {}));
  stats.kinetic_energy = 22.2;
  const auto broken = watch.check(five, stats, {});
  ASSERT_TRUE(broken);
  EXPECT_NEAR(broken->value, 100 * 2.2 / 42.2, 1e-12);
  stats.kinetic_energy = 20.2;
  stats.push_work = 2;  // work of the position correction at walls is no energy error
  stats.potential_energy = 82;
  EXPECT_FALSE(watch.check(parse_break_conditions("energy-rise=1"), stats, {}));
}

TEST(BreakConditions, EnergyOfAChangeIsNoRise) {
  BreakpointMonitor watch(start());
  const BreakConditions five = parse_break_conditions("energy-rise=5");
  StepStats before = well(), after = well();
  EXPECT_FALSE(watch.check(five, before, {}));
  after.kinetic_energy += 30;
  after.potential_energy += 10;
  watch.change(before, after);
  EXPECT_FALSE(watch.check(five, after, {}));
  after.kinetic_energy += 10;  // the scale is 70 J
  EXPECT_TRUE(watch.check(five, after, {}));
}

class OffendingBodies : public OnEachExecutor {};
ON_EACH_EXECUTOR(OffendingBodies);

TEST_P(OffendingBodies, AreNamed) {
  Scene scene = empty_space();
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(20, 20, 20)};
  scene.bodies = {sphere(1, Vector3d(5, 5, 5)), sphere(1, Vector3d(10, 5, 5), Vector3d(0, 3, 0)),
                  sphere(1, Vector3d(10, 6.5, 5)), sphere(1, Vector3d(15, 5, 0.2)),
                  sphere(1, Vector3d(15, 15, 15))};
  World world(scene, options());
  EXPECT_EQ(offending_body(world, BreakCondition::speed), 1u);
  EXPECT_EQ(offending_body(world, BreakCondition::penetration), 3u) << "0.8 m in the floor";
  EXPECT_EQ(offending_body(world, BreakCondition::energy_rise), std::nullopt);
  RunState state = world.state();
  state.bodies.position[3].z() = 0.9;
  state.bodies.position[4].x() = 21;
  world.restore(state);
  EXPECT_EQ(offending_body(world, BreakCondition::penetration), 4u) << "2 m in the wall";
  EXPECT_EQ(offending_body(world, BreakCondition::escaped), 4u);
  state.bodies.position[4].x() = 15;
  state.bodies.velocity[2].z() = std::numeric_limits<double>::infinity();
  world.restore(state);
  EXPECT_EQ(offending_body(world, BreakCondition::penetration), 1u) << "0.5 m in body 2";
  EXPECT_EQ(offending_body(world, BreakCondition::non_finite), 2u);
  EXPECT_EQ(offending_body(world, BreakCondition::escaped), std::nullopt);
}

}  // namespace
}  // namespace collidoscope
