#pragma once
// The settings that a study compares. Each series (solver, integrator, precision, continuous collision) has
// the same grid of time steps, substeps and iterations around the scene's own values. Settings rejected by
// validate() are excluded. Stateless functions.

#include <vector>

#include "sim_cuda/accuracy/problem.h"

namespace collidoscope {

/// All points from coarse to fine, with names and settings only. `fastest`: maximum speed of any body, in
/// m/s.
std::vector<AccuracyPoint> accuracy_settings(const AccuracyProblem& problem, double fastest);

/// Number of solves per simulated second; the sort key from coarse to fine.
double solves_per_second(const AccuracySetting& setting);

/// True if a point belongs to its series' refinement in time step: substeps and iterations are the scene's
/// own.
bool in_refinement_series(const AccuracyPoint& point, const AccuracyProblem& problem);

}  // namespace collidoscope
