// Tests the operations of soft_step on one contact, and how more passes over a chain converge.

#include <gtest/gtest.h>

#include "sim_cuda/solver/chain_passes.h"

namespace collidoscope {

namespace {

/// Two balls of 2 and 3 kg on the x axis.
struct TwoBalls {
  ContactBodies<double> bodies{};
  SoftContact<double> contact{};
  Vector3d v_a{0, 0, 0}, v_b{0, 0, 0};
  double mass = 1 / (1.0 / 2 + 1.0 / 3);

  TwoBalls(double gap, double impulse) {
    bodies.radius_a = bodies.radius_b = 1;
    bodies.inverse_mass_a = 1.0 / 2;
    bodies.inverse_mass_b = 1.0 / 3;
    contact.normal = Vector3d(1, 0, 0);
    contact.radius = 1;
    contact.gap = gap;
    contact.impulse = impulse;
  }
  double speed() const { return v_b.x() - v_a.x(); }  ///< m/s, separating
  template <class Act>
  void apply(const Act& act, double parts = 1) {
    const double change =
        act.solve_normal(contact, Motions<double>{{0, 1}, bodies, v_a, v_b, mass / parts, parts});
    v_a.x() -= change / 2;
    v_b.x() += change / 3;
  }
};

constexpr double h = 1.0 / 240;
Solve<double> solve_act() { return {Softness<double>::of(h, 1), 1e-3, false, false}; }

}  // namespace

TEST(ContactActs, ASmallGapKeepsTheImpulseThatKeepsItOpen) {
  // The balls separate only because of the impulse: without it, they would approach at 2 m/s. An impulse that
  // closes the gap in the substep remains.
  for (const double parts : {1.0, 4.0}) {
    TwoBalls balls(1e-5, 3);
    balls.v_b.x() = 3 / balls.mass - 2;
    ASSERT_GT(balls.speed(), 0);
    for (int pass = 0; pass < 200; ++pass) {
      balls.apply(solve_act(), parts);
      EXPECT_GT(balls.contact.impulse, 0) << parts << ' ' << pass;
    }
    EXPECT_NEAR(balls.speed(), -1e-5 / h, 1e-9) << parts;
    EXPECT_NEAR(balls.contact.impulse, (2 - 1e-5 / h) * balls.mass, 1e-9) << parts;
  }
}

TEST(ContactActs, BallsThatSeparateWithoutTheirImpulseLoseIt) {
  TwoBalls balls(1e-5, 3);
  balls.v_b.x() = 3 / balls.mass + 0.1;
  balls.apply(solve_act());
  EXPECT_EQ(balls.contact.impulse, 0);
  EXPECT_NEAR(balls.speed(), 0.1, 1e-12);
}

TEST(ContactActs, BallsThatMissWithoutTheirImpulseLoseIt) {
  // They pass each other within the substep: the sideways speed is 100 times the approach.
  TwoBalls balls(1e-2, 1);
  balls.v_b = Vector3d(1 / balls.mass - 3, 300, 0);
  balls.apply(solve_act());
  EXPECT_EQ(balls.contact.impulse, 0);
}

TEST(ContactActs, AChainContactThatLosesItsLoadStaysActive) {
  // In relax, a contact without an impulse is inactive. Over-relaxation may set one to 0 for a pass.
  const OverRelaxed<Relax<double, false, false>> act{{Softness<double>::of(h, 1), false}};
  TwoBalls balls(-1e-5, 3);
  balls.v_b.x() = 10;
  balls.apply(act);
  EXPECT_GT(balls.contact.impulse, 0);
  EXPECT_LT(balls.contact.impulse, 1e-20);
  EXPECT_NEAR(balls.speed(), 10 - 3 / balls.mass, 1e-12);
  balls.v_b.x() = balls.v_a.x() - 1;
  for (int pass = 0; pass < 100; ++pass) balls.apply(act);
  EXPECT_NEAR(balls.speed(), 0, 1e-12);
  EXPECT_NEAR(balls.contact.impulse, balls.mass, 1e-9);
}

}  // namespace collidoscope
