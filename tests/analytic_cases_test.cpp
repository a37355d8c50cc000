// Tests the analytic suite: every case passes on every executor, in double and in float, with its order
// within 0.15 of the theory. Also tests the evaluation itself: a coefficient that is wrong by 1 % must fail.

#include "sim_cuda/reference/analytic_cases.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "sim_cuda/reference/leading_error.h"
#include "sim_cuda/reference/oscillations.h"
#include "sim_cuda/scene/names.h"
#include "tests/executors.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

class Analytic : public OnEachExecutor {};
ON_EACH_EXECUTOR(Analytic);

TEST_P(Analytic, EveryCasePasses) {
  for (const AnalyticCase& one : analytic_cases())
    for (const AnalyticMethod& method : one.methods)
      for (const Precision precision : {Precision::f64, Precision::f32}) {
        const AnalyticResult r = run_case(one, method, precision, options());
        EXPECT_TRUE(r.passed()) << one.name << ' ' << name_of(method) << ' '
                                << name_of(precision_names, precision) << ": " << r.fault;
        if (r.method.theory.claim == Claim::leading && precision == Precision::f64) {
          // The theory is more than a bound. At the smallest step the measured error is within 5 % of it.
          EXPECT_NEAR(r.levels.back().error / r.method.theory.error(r.levels.back().h), 1, 0.05) << one.name;
        }
      }
}

TEST(AnalyticCases, AreWhatTheIssueAsksForAndEachSceneHasOne) {
  std::set<std::string> names, scenes;
  for (const AnalyticCase& one : analytic_cases()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name << " is there twice";
    scenes.insert(std::filesystem::path(one.scene.file).stem().string());
    EXPECT_FALSE(one.compared.empty());
    EXPECT_FALSE(one.rationale.empty());
    EXPECT_FALSE(one.methods.empty());
    const double steps = one.horizon / one.scene.physics.time_step;
    EXPECT_NEAR(steps, std::round(steps), 1e-9) << one.name << ": the horizon is between two steps";
  }
  EXPECT_GE(names.size(), 14u);
  for (const char* wanted : {"ballistic_flight", "head_on",         "oblique",
                             "spinning_bounce",  "cradle",          "bouncing",
                             "bouncing_bias",    "bouncing_energy", "zeno",
                             "slide_to_roll",    "incline_rolling", "stack_forces",
                             "symmetric_top",    "middle_axis",     "pendulum_small",
                             "pendulum_large",   "spring_force",    "spring_joint",
                             "drag_linear",      "drag_quadratic",  "orbit",
                             "head_on_1_to_3",   "cradle_touching", "oblate_top",
                             "incline_hollow",   "backspin"})
    EXPECT_TRUE(names.count(wanted)) << wanted;
  for (const auto& entry : std::filesystem::directory_iterator(project_file("assets/scenes/analytic")))
    EXPECT_TRUE(scenes.count(entry.path().stem().string())) << entry.path() << " is of no case";
}

// ---- evaluation ----

AnalyticResult of_errors(Theory theory, const std::vector<double>& errors) {
  AnalyticResult r;
  r.method.theory = std::move(theory);
  double h = 0.1;
  for (const double error : errors) {
    r.levels.push_back({h, 1, error, tolerance(r.method.theory, h, 1e-12)});
    h /= 2;
  }
  evaluate(r);
  return r;
}

TEST(AnalyticJudge, AsksForOrderAndConstant) {
  const Theory second{Claim::leading, 2, [](double h) { return 3 * h * h; }};
  EXPECT_TRUE(of_errors(second, {0.03, 0.0075, 0.001875, 0.00046875}).passed());
  EXPECT_NEAR(of_errors(second, {0.03, 0.0075, 0.001875, 0.00046875}).fitted_order, 2, 1e-12);
  EXPECT_FALSE(of_errors(second, {0.04, 0.01, 0.0025, 0.000625}).passed()) << "a third too much";
  EXPECT_FALSE(of_errors(second, {0.02, 0.01, 0.005, 0.0025}).passed()) << "first order";
  EXPECT_FALSE(of_errors(second, {0.02, 0.005, 0.00125, std::nan("")}).passed());
  const Theory bound{Claim::bound, 1, [](double h) { return h; }};
  EXPECT_TRUE(of_errors(bound, {0.01, 0.04, 0.0, 0.01}).passed()) << "less is no fault";
  EXPECT_FALSE(of_errors(bound, {0.01, 0.04, 0.0, 0.02}).passed());
  EXPECT_TRUE(of_errors({}, {1e-13, 1e-13, 1e-13, 1e-13}).passed());
  EXPECT_FALSE(of_errors({}, {1e-13, 1e-13, 1e-13, 1e-11}).passed());
}

/// Returns whether `step` passes the evaluation as the textbook method `book`.
bool passes(const OneStep& step, const OneStep& book, int order, const SmoothProblem& problem, double time) {
  const SmoothState end = problem.exact(time);
  const double constant = leading_error(problem, book, order, time).norm();
  AnalyticResult r;
  r.method.theory = leading_theory(order, constant);
  for (int steps = 40; steps <= 320; steps *= 2) {
    SmoothState y = problem.exact(0);
    for (int k = 0; k < steps; ++k) y = step(y, time / steps);
    const double h = time / steps;
    r.levels.push_back({h, steps, (y - end).norm(),
                        tolerance(r.method.theory, h, rounding(Precision::f64, steps, 10 * end.norm()))});
  }
  evaluate(r);
  return r.passed();
}

TEST(AnalyticJudge, SeesACoefficientThatIsOffByAHundredth) {
  const Rate spring_pull = [](const SmoothState& x) { return SmoothState(-x); };
  const SmoothProblem spring{second_order_rate(spring_pull),
                             [](double t) {
                               const Oscillation s = damped_oscillation(1, 0, t);
                               SmoothState y(2);
                               y << s.at, s.rate;
                               return y;
                             },
                             1};
  const double time = 7.5;
  const auto halves = [](const SmoothState& y) {
    return std::pair(SmoothState(y.head(1)), SmoothState(y.tail(1)));
  };
  const auto both = [](const SmoothState& x, const SmoothState& v) {
    SmoothState y(2);
    y << x, v;
    return y;
  };
  // Weights of the kicks and drifts. The correct value of each is 1.
  const auto euler = [&](std::array<double, 2> c) -> OneStep {
    return [=](const SmoothState& y, double h) {
      auto [x, v] = halves(y);
      v += c[0] * h * spring_pull(x);
      x += c[1] * h * v;
      return both(x, v);
    };
  };
  const auto verlet = [&](std::array<double, 3> c) -> OneStep {
    return [=](const SmoothState& y, double h) {
      auto [x, v] = halves(y);
      v += c[0] * h / 2 * spring_pull(x);
      x += c[1] * h * v;
      v += c[2] * h / 2 * spring_pull(x);
      return both(x, v);
    };
  };
  // Weights of the three inner stages, then of the four slopes in the sum.
  const auto rk4 = [&](std::array<double, 7> c) -> OneStep {
    return [=](const SmoothState& y, double h) {
      const SmoothState k1 = spring.rate(y), k2 = spring.rate(y + c[0] * h / 2 * k1),
                        k3 = spring.rate(y + c[1] * h / 2 * k2), k4 = spring.rate(y + c[2] * h * k3);
      return SmoothState(y + h / 6 * (c[3] * k1 + 2 * c[4] * k2 + 2 * c[5] * k3 + c[6] * k4));
    };
  };
  const auto expect_seen = [&](const auto& made, auto weights, const OneStep& book, int order) {
    weights.fill(1);
    EXPECT_TRUE(passes(made(weights), book, order, spring, time)) << "order " << order;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      auto injected = weights;
      injected[k] = 1.01;
      EXPECT_FALSE(passes(made(injected), book, order, spring, time))
          << "order " << order << ", weight " << k;
    }
  };
  expect_seen(euler, std::array<double, 2>{}, euler_step(spring_pull), 1);
  expect_seen(verlet, std::array<double, 3>{}, verlet_step(spring_pull), 2);
  expect_seen(rk4, std::array<double, 7>{}, rk4_step(spring.rate), 4);
}

}  // namespace
}  // namespace collidoscope
