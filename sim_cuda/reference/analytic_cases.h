#pragma once
// The cases of the analytic suite. Scenes are loaded from assets/scenes/analytic/, so the viewer can open
// them too. Closed forms read their parameters from the scene.

#include <vector>

#include "sim_cuda/reference/analytic_case.h"
#include "sim_cuda/reference/leading_error.h"

namespace collidoscope {

/// Groups of cases: smooth motion (errors from leading_error.h), impacts, contacts and joints (each error
/// derived at its case). Throw MachineError if the scenes are not found.
std::vector<AnalyticCase> smooth_cases();
std::vector<AnalyticCase> impact_cases();
std::vector<AnalyticCase> contact_cases();
std::vector<AnalyticCase> joint_cases();
/// All cases of the suite.
std::vector<AnalyticCase> analytic_cases();

/// Selects the compared part of a state.
using ComparedPart = std::function<SmoothState(const SmoothState&)>;
/// Theory from leading_error() of the compared part at `time`. Returns `exact` if the method has no leading
/// error in this case.
Theory smooth_theory(const SmoothProblem& problem, const OneStep& step, int order, double time,
                     const ComparedPart& part);

/// Reads the scene of a case, assets/scenes/analytic/<name>.json.
Scene analytic_scene(const std::string& name);

}  // namespace collidoscope
