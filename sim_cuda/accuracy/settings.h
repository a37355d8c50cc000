#pragma once
// Which settings a study tries: series (solver, integrator, precision, continuous collision), each with the
// same grid of time steps, substeps and iterations around the scene's own. One table; what a scene cannot be
// simulated with is left out by validate(). Free functions.

#include <vector>

#include "sim_cuda/accuracy/problem.h"

namespace collidoscope {

/// All points, with names and settings alone, from coarse to fine. `fastest`: m/s, of any body on the way.
std::vector<AccuracyPoint> accuracy_settings(const AccuracyProblem& problem, double fastest);

/// How many solves a second of simulated time is made of: what settings are ordered by, coarse to fine.
double solves_per_second(const AccuracySetting& setting);

/// Whether a point is on its refinement series of time steps, substeps and iterations being the scene's own.
bool in_refinement_series(const AccuracyPoint& point, const AccuracyProblem& problem);

}  // namespace collidoscope
