#include "sim_cuda/accuracy/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// The default integrator and rotation update are not named.
std::string series_name_of(const AccuracySetting& s) {
  const AccuracySetting usual;
  std::string name(name_of(solver_names, s.solver));
  if (s.integrator != usual.integrator) name += fmt::format(" {}", name_of(integrator_names, s.integrator));
  if (s.rotation_update != usual.rotation_update)
    name += fmt::format(" {}", name_of(rotation_update_names, s.rotation_update));
  name += fmt::format(" {}", name_of(precision_names, s.precision));
  if (s.continuous_collision) name += " continuous";
  return name;
}

std::string step_text(double step) {
  const double rate = 1 / step;
  return std::abs(rate - std::round(rate)) < 1e-9 * rate && rate > 0.5 ? fmt::format("1/{:.0f} s", rate)
                                                                       : fmt::format("{:.4g} s", step);
}

std::string point_name(const AccuracySetting& s) {
  std::string name = step_text(s.time_step);
  if (s.substeps > 1) name += fmt::format(", {} substeps", s.substeps);
  if (s.iterations > 1) name += fmt::format(", {} iterations", s.iterations);
  return name;
}

/// True if rotation updates differ: bodies with unequal moments of inertia rotate.
bool rotates_unequally(const AccuracyProblem& problem) {
  return problem.effects.rotation &&
         std::ranges::any_of(problem.initial.inertia, [](const Vector3d& moments) {
           return moments.x() != moments.y() || moments.y() != moments.z();
         });
}

/// True if integrators differ: forces change velocities, or rotation updates differ.
bool accelerates(const AccuracyProblem& problem) {
  const Effects& e = problem.effects;
  return e.gravity || e.attractor || e.drag || rotates_unequally(problem);
}

/// The series, each in float and in double:
/// - the scene's own solver with every integrator; the others use lie_group
/// - the other solvers with the scene's own integrator
/// - lie_group, and continuous collision off and on, if they make a difference
std::vector<AccuracySetting> series_settings(const AccuracyProblem& problem, double fastest) {
  const AccuracySetting own = problem.own_setting();
  double smallest = std::numeric_limits<double>::infinity();
  for (const double r : problem.initial.radius) smallest = std::min(smallest, r);
  const bool leaps = problem.initial.size() > 1 && fastest * problem.coarsest / problem.substeps > smallest;
  const bool turns = rotates_unequally(problem);
  std::vector<AccuracySetting> kinds;
  const auto add = [&](auto... changes) {
    AccuracySetting kind = own;
    (changes(kind), ...);
    kinds.push_back(kind);
  };
  const auto lie_group = [&](AccuracySetting& s) {
    if (turns) s.rotation_update = RotationUpdate::lie_group;
  };
  for (const auto& solver : solver_names) add([&](AccuracySetting& s) { s.solver = solver.value; });
  if (accelerates(problem))
    for (const auto& integrator : integrator_names)
      if (integrator.value != own.integrator)
        add([&](AccuracySetting& s) { s.integrator = integrator.value; }, lie_group);
  if (turns && own.rotation_update == RotationUpdate::first_order) add(lie_group);
  if (leaps || own.continuous_collision)
    add([&](AccuracySetting& s) { s.continuous_collision = !own.continuous_collision; });
  std::vector<AccuracySetting> all;
  for (AccuracySetting& kind : kinds)
    for (const auto& precision : precision_names) {
      kind.precision = precision.value;
      if (validate(with_setting(problem.scene, kind, problem.effects)).empty()) all.push_back(kind);
    }
  return all;
}

/// Number of substeps of a solver. 1 for `impulse`, whose substeps are equivalent to time steps.
int own_substeps(const AccuracyProblem& problem, Solver solver) {
  return solver == Solver::impulse                         ? 1
         : problem.scene.physics.solver == Solver::impulse ? 4
                                                           : problem.substeps;
}

}  // namespace

double solves_per_second(const AccuracySetting& s) {
  return (s.solver == Solver::impulse ? 1 : 2 + s.substeps) * std::sqrt(s.iterations) / s.time_step;
}

bool in_refinement_series(const AccuracyPoint& point, const AccuracyProblem& problem) {
  return point.setting.substeps == own_substeps(problem, point.setting.solver) &&
         point.setting.iterations == problem.scene.physics.iterations;
}

std::vector<AccuracyPoint> accuracy_settings(const AccuracyProblem& problem, double fastest) {
  const int iterations = problem.scene.physics.iterations;
  std::vector<AccuracyPoint> points;
  for (const AccuracySetting& series : series_settings(problem, fastest)) {
    const int own = own_substeps(problem, series.solver);
    const auto add = [&](int parts, int substeps, int sweeps) {
      AccuracyPoint& point = points.emplace_back();
      point.series_name = series_name_of(series);
      point.setting = series;
      point.setting.time_step = problem.coarsest / parts;
      point.setting.substeps = substeps;
      point.setting.iterations = sweeps;
      point.name = point_name(point.setting);
    };
    // Limit: 32 solves per step of the scene, or 8 per substep.
    const int finest = std::max(64, 16 * own);
    for (const int substeps : std::set{own, std::max(1, own / 4), own == 1 ? 1 : 4 * own})
      for (int parts = 1; parts * substeps <= finest; parts *= 2) add(parts, substeps, iterations);
    for (const int parts : {1, 2, 4}) add(parts, own, 4 * iterations);
  }
  std::ranges::stable_sort(points, {}, [](const AccuracyPoint& p) { return solves_per_second(p.setting); });
  return points;
}

}  // namespace collidoscope
