#pragma once
// Results of an accuracy study: settings with error and cost, the reference, the Pareto front and the
// recommendation. Plain data in SI units, used by panels, files and charts.
// A value is `not_known` if it does not apply or is not measured yet.

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim_cuda/scene/settings_patch.h"

namespace collidoscope {

inline constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// The settings that a study varies. All others are the scene's.
struct AccuracySetting {
  double time_step = 1.0 / 30;  ///< s
  int substeps = 4;
  int iterations = 1;
  Solver solver = Solver::soft_step;
  Integrator integrator = Integrator::semi_implicit_euler;
  RotationUpdate rotation_update = RotationUpdate::lie_group;
  Precision precision = Precision::f32;
  bool continuous_collision = false;

  friend bool operator==(const AccuracySetting&, const AccuracySetting&) = default;
};

/// The settings of a scene with the given number of substeps and the given effects.
AccuracySetting accuracy_setting(const Physics& physics, int substeps, const Effects& effects);
/// The setting as a patch, without continuous collision.
SettingsPatch patch_of(const AccuracySetting& setting);

/// The scene with these settings. `effects` are the fixed effects, except continuous collision. They must not
/// vary with the time step, as they may with "auto".
Scene with_setting(const Scene& scene, const AccuracySetting& setting, const Effects& effects);

/// Wall-clock milliseconds per simulated second: median and quartiles of several runs.
struct AccuracyCost {
  double median = not_known, low = not_known, high = not_known;
};

/// Invariants, each the worst value of the sampled states.
struct AccuracyInvariants {
  double energy_drift = not_known;  ///< (E(end) - E(start)) over the reference's maximum kinetic energy
  double energy_error = not_known;  ///< difference to the reference's energy at the same time, over the same
                                    ///< scale
  /// Change of momentum minus the impulses of walls and gravity, over the sum of m |v|.
  double momentum_balance = not_known;
  /// Change of angular momentum minus the known torques, over the sum of m |v| times the extent of the
  /// bodies.
  double angular_momentum_balance = not_known;
  double angular_momentum_error = not_known;   ///< difference to the reference's, over the same scale
  double penetration_max = not_known;          ///< m, of two bodies, or of a body and a wall
  double penetration_rms = not_known;          ///< m, of overlapping pairs of bodies; 0 without overlap
  double penetration_over_radius = not_known;  ///< r.m.s. over overlapping pairs, relative to the smaller
                                               ///< radius
  double joint_error = not_known;              ///< m
  double joint_angle = not_known;              ///< rad
  double cone_violation = not_known;  ///< friction impulse beyond the cone, relative to the largest allowed
                                      ///< one
};

/// Wasserstein distances between the final distributions over all bodies and those of the reference. They
/// remain meaningful after positions have diverged.
struct AccuracyDistributions {
  double heights = not_known;  ///< m, along gravity; along z without gravity
  double speeds = not_known;   ///< m/s
};

struct AccuracyPoint {
  std::string series_name;  ///< "soft_step f32": name of the point's series
  std::string name;         ///< "1/60 s, 4 substeps, 1 iteration": name within the series
  AccuracySetting setting;
  /// m, r.m.s. displacement of the bodies' points over all bodies and samples, rotations included. `low` and
  /// `high`: one standard error below and above, from the spread between groups of bodies.
  double error = not_known, error_low = not_known, error_high = not_known;
  double error_worst = not_known;  ///< m, maximum over bodies and samples
  AccuracyCost ms;                 ///< per simulated second
  std::vector<double> ms_runs;     ///< individual runs; `ms` is their median
  AccuracyInvariants invariants;
  AccuracyDistributions distributions;
  bool on_front = false;  ///< Pareto-optimal: no other point is both cheaper and more accurate

  bool has_error() const { return error == error; }
  bool has_cost() const { return ms.median == ms.median; }
};

/// The reference that errors are measured against.
struct AccuracyReference {
  enum class Kind { hard_spheres, converged_run };
  Kind kind = Kind::converged_run;
  std::string description;  ///< one line
  double seconds = 0;       ///< s, duration
  double horizon = 0;       ///< s, limit for comparing positions; at most `seconds`
  std::string end;          ///< one line: reason for the limited horizon; empty: not limited
  double error = 0;  ///< m, error of the reference itself (r.m.s. as for a point); smaller errors are not
                     ///< significant
  double order = not_known;          ///< observed order of convergence, of a converged run
  double lyapunov_rate = not_known;  ///< 1/s, growth rate of a small displacement
};

/// Marks the points on the Pareto front among those with an error and a cost.
void mark_front(std::vector<AccuracyPoint>& points);

/// Index of the cheapest point with an error of at most `tolerance` m. Unset if there is none.
std::optional<std::size_t> cheapest_below(std::span<const AccuracyPoint> points, double tolerance);

/// The recommended setting, or the reason for its absence.
struct Recommendation {
  std::optional<std::size_t> point;  ///< cheapest point below the tolerance
  std::string unavailable_reason;    ///< one line; empty if there is a point
};
/// Recommends a setting. `reference_error` in m: smaller errors are not significant. There is no
/// recommendation if all errors, or the tolerance, are below it.
Recommendation recommended(std::span<const AccuracyPoint> points, double reference_error, double tolerance);
/// True if at least one error is measured and none exceeds the reference's own error.
bool all_below_reference(std::span<const AccuracyPoint> points, double reference_error);

}  // namespace collidoscope
