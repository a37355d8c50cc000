#pragma once
// Runs of random scenes whose energy is checked at every step (energy_bounds_test.cpp).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "tests/energy_scenes.h"
#include "tests/executors.h"

namespace collidoscope {

inline constexpr double contact_bound = 1e-3;  ///< of T
inline constexpr double joint_bound = 5e-3;

/// Seeds of `count` scenes, then `more`: seeds that failed once among 100 times as many scenes. With a
/// sanitizer, whose task is to find errors in memory, a tenth of `count` and none of `more`. The same with
/// the CUDA executor: its states have the bits of the CPU's, which OneAnswer and `gpu-check agreement`
/// compare.
inline std::vector<int> energy_seeds([[maybe_unused]] ExecutorKind executor, int count,
                                     const std::vector<int>& more = {}) {
  if (const char* const seed = std::getenv("COLLIDOSCOPE_ENERGY_SEED")) return {std::atoi(seed)};
#ifdef WITH_SANITIZER
  const bool few = true;
#else
  const bool few = executor == ExecutorKind::cuda;
#endif
  if (few) count = (count + 9) / 10;
  const char* const asked = std::getenv("COLLIDOSCOPE_ENERGY_SCENES");
  std::vector<int> seeds(static_cast<std::size_t>(asked != nullptr ? count * std::atoi(asked) : count));
  std::iota(seeds.begin(), seeds.end(), 0);
  for (const int seed : more)
    if (!few && seed >= static_cast<int>(seeds.size())) seeds.push_back(seed);
  return seeds;
}

struct EnergyCourse {
  double rise = 0;        ///< largest rise of E above its earlier minimum, relative to T
  std::int64_t step = 0;  ///< the state of that rise
  double push_work = 0;   ///< largest, relative to the final T
  double stopping = 0;    ///< largest magnitude of negative push_work, relative to the final T
  StepStats end;
};

inline EnergyCourse energy_course(const Scene& scene, int steps, const RunOptions& options) {
  World world(scene, options);
  Vector3d kinematic_velocity(0, 0, 0);
  double mass = 0;  // kg, of dynamic bodies
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].motion == Motion::dynamic)
      mass += world.initial().mass[i];
    else if (scene.bodies[i].motion == Motion::kinematic)
      kinematic_velocity = scene.bodies[i].velocity;
  const Vector3d start = vector_of(world.measure().momentum);
  EnergyCourse course;
  double lowest = 0, largest_kinetic = 0;
  for (int k = 0; k <= steps; ++k) {
    if (k > 0) world.step();
    const StepStats now = world.measure();
    course.end = now;
    const Vector3d impulse = vector_of(now.momentum) - start - vector_of(now.wall_impulse_vector) -
                             mass * world.time() * scene.physics.gravity;
    const double energy = now.energy() - now.push_work - kinematic_velocity.dot(impulse);
    largest_kinetic = std::max(largest_kinetic, now.kinetic_energy);
    course.push_work = std::max(course.push_work, now.push_work);
    course.stopping = std::max(course.stopping, -now.push_work);
    if (k == 0) lowest = energy;
    if (energy - lowest > course.rise * largest_kinetic) {
      course.rise = (energy - lowest) / largest_kinetic;
      course.step = k;
    }
    lowest = std::min(lowest, energy);
  }
  course.push_work /= largest_kinetic;
  course.stopping /= largest_kinetic;
  return course;
}

class EnergyBounds : public OnEachExecutor {
 protected:
  using Maker = std::function<Scene(Uniform&)>;

  struct Runs {
    double EnergyCourse::*value = &EnergyCourse::rise;
    std::vector<Solver> solvers{Solver::soft_step, Solver::jacobi_split, Solver::impulse};
    std::vector<int> rates{30, 60, 120, 240, 1000};
    bool one_solver = false;      ///< a different one for every second scene
    std::vector<int> seeds = {};  ///< in addition: those that failed once among 100 times as many scenes
    double share_above = 0;       ///< share of the runs that may exceed the bound
    double most = 0;              ///< what these must not exceed
  };

  /// Runs `count` scenes of `make` for `seconds`, at most 400 steps, with every solver that supports them.
  /// The value of each run must be at most `bound`.
  void check(int count, double seconds, double bound, const Maker& make, const Runs& each) {
    const auto& [value, solvers, rates, one_solver, seeds, share_above, most] = each;
    int runs = 0, failures = 0;
    double worst = bound;
    std::string report, lines;  // the worst; the first 20
    for (const int seed : energy_seeds(GetParam(), count, seeds)) {
      Uniform uniform{Random(static_cast<std::uint32_t>(seed))};
      const int rate = rates[uniform.random() % rates.size()];
      Scene scene = make(uniform);
      scene.physics.time_step = TimeStep::per_second(rate);
      scene.physics.precision = seed % 2 == 0 ? Precision::f32 : Precision::f64;
      const std::size_t chosen = static_cast<std::size_t>(seed / 2) % solvers.size();
      for (const Solver solver : solvers) {
        if (one_solver && solver != solvers[chosen]) continue;
        scene.physics.solver = solver;
        if (!validate(scene).empty()) {
          ASSERT_EQ(solver, Solver::impulse) << line_of(validate(scene)[0]);
          continue;
        }
        const int steps = std::min(static_cast<int>(seconds * rate), 400);
        const EnergyCourse course = energy_course(scene, steps, options());
        ASSERT_EQ(course.end.non_finite, 0) << write_scene(scene);
        ASSERT_EQ(course.end.escaped, 0) << write_scene(scene);
        ++runs;
        if (!(course.*value > bound)) continue;
        ++failures;
        std::ostringstream line;
        line << course.*value << ", seed " << seed << ", " << name_of(solver_names, solver) << ", "
             << name_of(precision_names, scene.physics.precision) << ", " << rate << "/s, state "
             << course.step << '\n';
        if (failures <= 20) lines += line.str();
        if (!(course.*value > worst)) continue;
        worst = course.*value;
        report = line.str() + write_scene(scene);
      }
    }
    EXPECT_LE(failures, share_above * runs) << "of " << runs << " runs; allowed " << bound << '\n'
                                            << lines << "worst: " << report;
    EXPECT_LE(worst, std::max(most, bound)) << report;
  }
  void check_contacts(int count, double seconds, const Maker& make, const std::vector<int>& seeds = {}) {
    check(count, seconds, contact_bound, make, {.seeds = seeds});
  }
  /// One solver per scene, since bodies seldom touch.
  void check_joints(int count, const Maker& make) {
    check(count, 3, joint_bound, make,
          {.solvers = {Solver::soft_step, Solver::jacobi_split}, .one_solver = true});
  }
};

}  // namespace collidoscope
