#pragma once
// A case of the analytic suite: a scene with a closed-form solution, the compared quantity, and the
// theoretical error for a step of h seconds. Also runs a case at decreasing steps and checks the errors.
// A case is a value that owns all its data.

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/world.h"

namespace collidoscope {

enum class Claim {
  exact,    ///< rounding errors only, for every h
  leading,  ///< error(h) plus higher-order terms; the fitted order is checked
  bound,    ///< at most error(h); depends on the times of impacts within a step, so no order is fitted
};

struct Theory {
  Claim claim = Claim::exact;
  double order = 0;                            ///< order in h; unused for `exact`
  std::function<double(double h)> error = {};  ///< h in s, error in the compared unit; unused for `exact`
};

/// Theory with a leading error of constant h^order and higher-order terms.
Theory leading_theory(double order, double constant);

/// A method for running a case, and its theory.
struct AnalyticMethod {
  Integrator integrator = Integrator::velocity_verlet;
  Theory theory;
  RotationUpdate rotation_update = RotationUpdate::lie_group;
  Solver solver = Solver::soft_step;
};
/// "rk4", "semi_implicit_euler, first_order", or "velocity_verlet, jacobi_split".
std::string name_of(const AnalyticMethod& method);
/// The same without the solver.
std::string integrator_of(const AnalyticMethod& method);

/// The list with the default integrator only, for cases in which all integrators are the same: motion with
/// contacts or joints, which is semi-implicit Euler's for every integrator, and free motion without forces.
/// `solvers`: those with this theory.
std::vector<AnalyticMethod> by_any_integrator(const Theory& theory,
                                              std::initializer_list<Solver> solvers = {Solver::soft_step,
                                                                                       Solver::jacobi_split});

struct AnalyticCase {
  std::string name;       ///< words_with_underscores
  Scene scene;            ///< with the largest step
  std::string compared;   ///< quantity and unit: "height, m"
  std::string rationale;  ///< one line that explains the theoretical error
  double horizon = 1;     ///< s, an integer multiple of the largest step
  int refinement = 2;     ///< ratio of the steps of two consecutive levels
  /// Largest value affected by rounding, in the compared unit. Each step adds half a unit in its last place.
  double scale = 1;
  std::vector<AnalyticMethod> methods;
  /// Advances a new world by `steps` steps to the horizon. Returns the error in the compared unit.
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
  double fitted_order = 0;            ///< NaN if no order is fitted
  std::string fault;                  ///< one line; empty: passed
  bool passed() const { return fault.empty(); }
};

inline constexpr int analytic_levels = 4;
/// Allowed difference between the fitted and the theoretical order.
inline constexpr double order_tolerance = 0.15;

/// Bound of the rounding error. Each step rounds a few quantities by half a unit in the last place of
/// `scale`, and these errors accumulate.
double rounding(Precision precision, int steps, double scale);

/// Largest allowed error. An order deviation of 0.15 over one halving of h corresponds to higher-order terms
/// of 2 (2^0.15 - 1) = 22 % of the leading term. The tolerance adds this fraction.
double tolerance(const Theory& theory, double h, double rounding);

/// Least-squares slope of log error over log h.
double fitted_order(const std::vector<AnalyticLevel>& levels);

/// Sets the fitted order and the fault of a result with known levels. Float results get no fitted order,
/// because rounding dominates.
void evaluate(AnalyticResult& result);

/// Runs a case at all levels. Throws the same exceptions as World.
AnalyticResult run_case(const AnalyticCase& one, const AnalyticMethod& method, Precision precision,
                        const RunOptions& options);

}  // namespace collidoscope
