#pragma once
// The analytic suite: every case there is. Scenes come from assets/scenes/analytic/, so that each can be
// opened in the window, too; closed forms read their numbers from the scene.

#include <vector>

#include "sim_cuda/reference/analytic_case.h"
#include "sim_cuda/reference/leading_error.h"

namespace collidoscope {

/// Cases of smooth motion, whose errors leading_error.h knows; of impacts, of what stays in touch, and of
/// joints, each with a derivation of its own. Throw MachineError where the scenes are not found.
std::vector<AnalyticCase> smooth_cases();
std::vector<AnalyticCase> impact_cases();
std::vector<AnalyticCase> contact_cases();
std::vector<AnalyticCase> joint_cases();
/// All of them.
std::vector<AnalyticCase> analytic_cases();

/// What of a state is compared.
using ComparedPart = std::function<SmoothState(const SmoothState&)>;
/// leading_error() of what is compared at `time`; exact where a method happens to miss nothing.
Theory smooth_theory(const SmoothProblem& problem, const OneStep& step, int order, double time,
                     const ComparedPart& part);

/// The scene of a case, assets/scenes/analytic/<name>.json.
Scene analytic_scene(const std::string& name);

}  // namespace collidoscope
