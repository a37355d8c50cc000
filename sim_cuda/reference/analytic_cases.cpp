#include "sim_cuda/reference/analytic_cases.h"

#include <cmath>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

Scene analytic_scene(const std::string& name) {
  return read_scene(asset("scenes/analytic/" + name + ".json").string());
}

Theory smooth_theory(const SmoothProblem& problem, const OneStep& step, int order, double time,
                     const ComparedPart& part) {
  const SmoothState end = problem.exact(time), off = leading_error(problem, step, order, time);
  if (off.norm() == 0) return {};
  const double small = 1e-4 * end.norm() / off.norm();
  const double constant = ((part(end + small * off) - part(end - small * off)) / (2 * small)).norm();
  // Zero leading error: for example, Verlet's kick solves quadratic drag exactly.
  if (constant < 1e-6 * part(end).norm() * std::pow(problem.fastest, order)) return {};
  return leading_theory(order, constant);
}

std::vector<AnalyticCase> analytic_cases() {
  std::vector<AnalyticCase> all = smooth_cases();
  for (const auto& more : {impact_cases(), contact_cases(), joint_cases()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace collidoscope
