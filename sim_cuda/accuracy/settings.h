#pragma once
// Which settings a study tries: families (solver, integrator, precision, continuous collision), each with the
// same grid of time steps, substeps and iterations around the scene's own. One table; what a scene cannot be
// simulated with is left out by validate(). Free functions.

#include <vector>

#include "sim_cuda/accuracy/subject.h"

namespace collidoscope {

/// All points, with names and settings alone, from coarse to fine. `fastest`: m/s, of any body on the way.
std::vector<AccuracyPoint> accuracy_settings(const AccuracySubject& subject, double fastest);

/// How many solves a second of simulated time is made of: what settings are ordered by, coarse to fine.
double fineness(const AccuracySetting& setting);

/// Whether a point is on its family's ladder of time steps, substeps and iterations being the scene's own.
bool on_ladder(const AccuracyPoint& point, const AccuracySubject& subject);

}  // namespace collidoscope
