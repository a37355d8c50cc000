#pragma once
// A case of the analytic suite: a scene whose course is known in closed form, what of it is compared, and
// what theory says the error of a step of h seconds comes to. Running a case at ever smaller steps, and
// judging what came of it. Cases are values that own what they need; they live as long as their caller likes.

#include <functional>
#include <string>
#include <vector>

#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/world.h"

namespace collidoscope {

enum class Claim {
  exact,    ///< nothing but rounding, whatever h
  leading,  ///< error(h) and terms of higher order: checked with the fitted order
  bound,    ///< at most error(h); how much less goes by where impacts fall in a step, so no order is fitted
};

struct Theory {
  Claim claim = Claim::exact;
  double order = 0;                            ///< of h; not of `exact`
  std::function<double(double h)> error = {};  ///< s to the unit compared; not of `exact`
};

/// constant h^order, and terms of higher order.
Theory leading_theory(double order, double constant);

/// One way to run a case, and what is to be expected of it.
struct AnalyticMethod {
  Integrator integrator = Integrator::semi_implicit_euler;
  Theory theory;
  RotationUpdate rotation_update = RotationUpdate::first_order;  ///< told only where something turns
};
/// "rk4", or "rk4, lie_group".
std::string name_of(const AnalyticMethod& method);

/// What touches or is jointed goes on by Euler's method whatever integrator there is: one way is enough.
std::vector<AnalyticMethod> by_euler(Theory theory);

struct AnalyticCase {
  std::string name;       ///< words_with_underscores
  Scene scene;            ///< at the largest step
  std::string compared;   ///< "height, m"
  std::string rationale;  ///< why the error of Euler's method is what theory says, in a line
  double horizon = 1;     ///< s, a whole number of the largest steps
  int refinement = 2;     ///< each level's step over the next one's
  /// The largest number that rounding acts on, in the unit compared: what half a unit in its last place comes
  /// to, at each step.
  double scale = 1;
  std::vector<AnalyticMethod> methods;
  /// Steps a fresh world `steps` times, up to the horizon; the error, in the unit compared.
  std::function<double(World&, int steps)> error;
};

struct AnalyticLevel {
  double h = 0;  ///< s
  int steps = 0;
  double error = 0, tolerance = 0;
};

struct AnalyticResult {
  std::string name, compared, rationale;
  AnalyticMethod method;
  Precision precision = Precision::f64;
  std::vector<AnalyticLevel> levels;  ///< from the largest step to the smallest
  double fitted_order = 0;            ///< NaN where no order is fitted
  std::string fault;                  ///< a line; empty: passed
  bool passed() const { return fault.empty(); }
};

inline constexpr int analytic_levels = 4;
/// How far the fitted order may be from theory's.
inline constexpr double order_tolerance = 0.15;

/// What rounding may come to: each step rounds a few quantities, each by half a unit in the last place of
/// `scale`, and nothing takes it away again.
double rounding(Precision precision, int steps, double scale);

/// What an error may come to. An order that is off by 0.15 over one halving of h means that the terms left
/// out are 2 (2^0.15 - 1) = 22 % of the leading one at the larger step: so much more than it is allowed.
double tolerance(const Theory& theory, double h, double rounding);

/// The slope of log error over log h, by least squares.
double fitted_order(const std::vector<AnalyticLevel>& levels);

/// Fills in the fitted order and the fault of a result whose levels are known. In float no order is fitted:
/// rounding hides it.
void evaluate(AnalyticResult& result);

/// Throws what World throws.
AnalyticResult run_case(const AnalyticCase& one, const AnalyticMethod& method, Precision precision,
                        const RunOptions& options);

}  // namespace collidoscope
