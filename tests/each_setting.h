#pragma once
// Runs a check with a world of a scene for `soft_step` and `jacobi_split`, each in both precisions.

#include <gtest/gtest.h>

#include <string>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/world.h"

namespace collidoscope {

/// Calls `check(world)` for each setting. `half`: only for soft_step in float and jacobi_split in double.
template <class Check>
void for_each_setting(Scene scene, const RunOptions& options, const Check& check, bool half = false) {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Solver solver : {Solver::soft_step, Solver::jacobi_split}) {
      if (half && (precision == Precision::f32) != (solver == Solver::soft_step)) continue;
      scene.physics.solver = solver;
      scene.physics.precision = precision;
      SCOPED_TRACE(std::string(name_of(solver_names, solver)) + ", " +
                   std::string(name_of(precision_names, precision)));
      World world(scene, options);
      check(world);
    }
}

}  // namespace collidoscope
