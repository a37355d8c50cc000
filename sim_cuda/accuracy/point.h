#pragma once
// What an accuracy study finds: settings, each with its error and its cost; what the errors are measured
// against; and the two questions asked of them. Plain data in SI units, read by panels, files and charts
// alike. `not_known` stands where a quantity does not apply, or is not measured yet.

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim_cuda/scene/settings_patch.h"

namespace collidoscope {

inline constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// All that a study varies. Everything else is the scene's.
struct AccuracySetting {
  double time_step = 1.0 / 30;  ///< s
  int substeps = 4;
  int iterations = 1;
  Solver solver = Solver::soft_step;
  Integrator integrator = Integrator::semi_implicit_euler;
  RotationUpdate rotation_update = RotationUpdate::first_order;
  Precision precision = Precision::f32;
  bool continuous_collision = false;

  friend bool operator==(const AccuracySetting&, const AccuracySetting&) = default;
};

/// Those of a scene whose steps have `substeps` and whose effects are `effects`.
AccuracySetting accuracy_setting(const Physics& physics, int substeps, const Effects& effects);
/// The same as settings, but for the continuous collision.
SettingsPatch patch_of(const AccuracySetting& setting);

/// The scene with these settings, whose effects, but for continuous collision, are `effects`: what is on must
/// not go by the time step, as it may where the scene says "auto".
Scene with_setting(const Scene& scene, const AccuracySetting& setting, const Effects& effects);

/// Milliseconds of the clock for a simulated second: the middle of some runs, and their quartiles.
struct AccuracyCost {
  double median = not_known, low = not_known, high = not_known;
};

/// What must be kept, or must be zero, whatever the motion; each the worst of the sampled states.
struct AccuracyInvariants {
  double energy_drift =
      not_known;  ///< of the end against the start, over the reference's most kinetic energy
  double energy_error = not_known;  ///< the same, against the reference's energy at the same time
  /// What is left of the change of momentum without what walls and gravity gave, over the sum of m |v|.
  double momentum_balance = not_known;
  /// The same of the angular momentum, over the sum of m |v| and the extent of the bodies.
  double angular_momentum_balance = not_known;
  double angular_momentum_error = not_known;   ///< against the reference's, over the same
  double penetration_max = not_known;          ///< m, of two bodies, or of a body and a wall
  double penetration_rms = not_known;          ///< m, of the pairs of bodies that overlap; 0 where none does
  double penetration_over_radius = not_known;  ///< of pairs, r.m.s., over the radius of the smaller
  double joint_error = not_known;              ///< m
  double joint_angle = not_known;              ///< rad
  double cone_violation = not_known;  ///< friction beyond its coefficient times the normal impulse, over that
};

/// How far a setting's distributions over all bodies are from the reference's at the end, also where
/// positions mean nothing any more: by how much values must be moved, on average, to make one of the other.
struct AccuracyDistributions {
  double heights = not_known;  ///< m, along gravity, or z where there is none
  double speeds = not_known;   ///< m/s
};

struct AccuracyPoint {
  std::string series_name;  ///< "soft_step f32": the points of one line
  std::string name;         ///< "1/60 s, 4 substeps, 1 iteration": which of them
  AccuracySetting setting;
  /// m, root mean square over all bodies and samples of how far a body's matter is from where it should be,
  /// turns included; and a standard error below and above, by how groups of bodies differ.
  double error = not_known, error_low = not_known, error_high = not_known;
  double error_worst = not_known;  ///< m, of any body at any sample
  AccuracyCost ms;                 ///< for a simulated second
  std::vector<double> ms_runs;     ///< each run's, of which `ms` is the middle
  AccuracyInvariants invariants;
  AccuracyDistributions distributions;
  bool on_front = false;  ///< nothing else is both as cheap and as accurate

  bool has_error() const { return error == error; }
  bool has_cost() const { return ms.median == ms.median; }
};

/// What errors are measured against.
struct AccuracyReference {
  enum class Kind { hard_spheres, converged_run };
  Kind kind = Kind::converged_run;
  std::string description;           ///< a line
  double seconds = 0;                ///< s, for which it goes on
  double horizon = 0;                ///< s, up to which positions are compared; at most `seconds`
  std::string end;                   ///< a line: why no further, or empty
  double error = 0;                  ///< m, its own, r.m.s. as a point's; what is below it means nothing
  double order = not_known;          ///< observed, of a converged run
  double lyapunov_rate = not_known;  ///< 1/s, at which a tiny displacement grows exponentially
};

/// Marks the points on the Pareto front, of those with both an error and a cost.
void mark_front(std::vector<AccuracyPoint>& points);

/// Which point is the cheapest whose error is at most `tolerance`, m; none where no point is.
std::optional<std::size_t> cheapest_below(std::span<const AccuracyPoint> points, double tolerance);

/// The setting to recommend, or why there is none.
struct Recommendation {
  std::optional<std::size_t> point;  ///< the cheapest below the tolerance
  std::string unavailable_reason;    ///< a line; empty where there is a point
};
/// `reference_error`, m: what lies below it cannot be told from it. So none is recommended where all errors,
/// or the tolerance, lie below.
Recommendation recommended(std::span<const AccuracyPoint> points, double reference_error, double tolerance);
/// Whether no measured error is above the reference's own. False where none is measured.
bool all_below_reference(std::span<const AccuracyPoint> points, double reference_error);

}  // namespace collidoscope
