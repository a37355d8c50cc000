#include "sim_cuda/reference/analytic_case.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

/// The scene with its time step divided by `parts`.
Scene refined(Scene scene, int parts) {
  TimeStep& step = scene.physics.time_step;
  if (const auto n = step.steps_per_second())
    step = TimeStep::per_second(*n * parts);
  else
    step = step / parts;
  return scene;
}

}  // namespace

std::string integrator_of(const AnalyticMethod& method) {
  std::string text(name_of(integrator_names, method.integrator));
  if (method.rotation_update == RotationUpdate::first_order) text += ", first_order";
  return text;
}

std::string name_of(const AnalyticMethod& method) {
  std::string text = integrator_of(method);
  if (method.solver != Solver::soft_step) text += ", " + std::string(name_of(solver_names, method.solver));
  return text;
}

Theory leading_theory(double order, double constant) {
  return {Claim::leading, order, [=](double h) { return constant * std::pow(h, order); }};
}

std::vector<AnalyticMethod> by_any_integrator(const Theory& theory, std::initializer_list<Solver> solvers) {
  std::vector<AnalyticMethod> methods;
  for (const Solver solver : solvers) methods.push_back({.theory = theory, .solver = solver});
  return methods;
}

double rounding(Precision precision, int steps, double scale) {
  constexpr double quantities = 4;
  const double half_unit = precision == Precision::f64 ? 0x1p-53 : 0x1p-24;
  return quantities * half_unit * steps * scale;
}

double tolerance(const Theory& theory, double h, double rounding) {
  if (theory.claim == Claim::exact) return rounding;
  return (1 + 2 * (std::exp2(order_tolerance) - 1)) * theory.error(h) + rounding;
}

double fitted_order(const std::vector<AnalyticLevel>& levels) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const AnalyticLevel& level : levels) {
    const double u = std::log(level.h), v = std::log(level.error);
    n += 1;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

void evaluate(AnalyticResult& result) {
  result.fitted_order = std::numeric_limits<double>::quiet_NaN();
  result.fault.clear();
  for (const AnalyticLevel& level : result.levels)
    if (!(level.error <= level.tolerance)) {
      result.fault = fmt::format("at h = {:.4g} s the error is {:.3g}; the limit is {:.3g}", level.h,
                                 level.error, level.tolerance);
      break;
    }
  if (result.method.theory.claim != Claim::leading || result.precision == Precision::f32) return;
  result.fitted_order = fitted_order(result.levels);
  if (!(std::abs(result.fitted_order - result.method.theory.order) <= order_tolerance))
    result.fault =
        fmt::format("the fitted order is {:.2f}; the theoretical order is {:g}{}{}", result.fitted_order,
                    result.method.theory.order, result.fault.empty() ? "" : "; ", result.fault);
}

AnalyticResult run_case(const AnalyticCase& one, const AnalyticMethod& method, Precision precision,
                        const RunOptions& options) {
  AnalyticResult result{one.name, one.compared, one.rationale, method, precision, {}, 0, ""};
  int parts = 1;
  for (int k = 0; k < analytic_levels; ++k, parts *= one.refinement) {
    Scene scene = refined(one.scene, parts);
    scene.physics.precision = precision;
    scene.physics.integrator = method.integrator;
    scene.physics.rotation_update = method.rotation_update;
    scene.physics.solver = method.solver;
    World world(scene, options);
    AnalyticLevel level;
    level.h = scene.physics.time_step / world.substeps();
    level.steps = static_cast<int>(std::lround(one.horizon / scene.physics.time_step));
    level.error = one.error(world, level.steps);
    level.tolerance = tolerance(method.theory, level.h, rounding(precision, level.steps, one.scale));
    result.levels.push_back(level);
  }
  evaluate(result);
  return result;
}

}  // namespace collidoscope
