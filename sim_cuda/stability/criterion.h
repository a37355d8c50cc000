#pragma once
// The criterion of a hard case: assertions about its scene, duration, expected failures, and injected faults
// that prove that assertions can fail. Plain data and the reader of its file.
// The file is JSON with comments, `"format": "collidoscope-criterion", "version": 1`. README.md of this
// folder lists its members.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Measurable quantities; quantities.h has the definitions.
enum class Quantity {
  finite,
  penetration,
  penetration_over_radius,
  speed,
  angular_speed,
  energy_gain,
  energy_loss,
  kinetic_energy,
  escaped,
  displacement,
  position,
  velocity,
  momentum_change,
  angular_momentum_change,
  quaternion_norm,
  joint_error,
  joint_angle,
  pairs,
  touching,
  speculative,
  asleep,
  tree_depth,
  difference,
  separation_speed,
  other_hash,
  expected_finding
};
/// The help is Markdown.
inline constexpr auto quantity_names = std::to_array<Named<Quantity>>({
    {"finite", Quantity::finite, "all bodies are finite"},
    {"penetration", Quantity::penetration, "deepest overlap of two bodies, or of a body and a wall"},
    {"penetration_over_radius", Quantity::penetration_over_radius,
     "largest overlap over the radius; of two bodies, over that of the smaller one"},
    {"speed", Quantity::speed, "largest speed of a body"},
    {"angular_speed", Quantity::angular_speed, "largest angular speed of a body"},
    {"energy_gain", Quantity::energy_gain,
     "(E − E₀ − W)/S: E kinetic and potential energy, W the potential energy added by overlap "
     "recovery, S the largest kinetic energy plus |change of potential energy| so far; 0 if both are 0"},
    {"energy_loss", Quantity::energy_loss, "−`energy_gain`"},
    {"kinetic_energy", Quantity::kinetic_energy, "kinetic energy of the dynamic bodies"},
    {"escaped", Quantity::escaped, "number of bodies whose centres are outside the box"},
    {"displacement", Quantity::displacement, "largest distance of a body from its position at state `since`"},
    {"position", Quantity::position, "position along the axis"},
    {"velocity", Quantity::velocity, "velocity along the axis"},
    {"momentum_change", Quantity::momentum_change,
     "|p − p₀ − J − m·g·t|/S: the momentum change not caused by the walls' impulse J or by gravity; S the "
     "largest of the sums of m·|v| and of m·|x − x₀|/t so far"},
    {"angular_momentum_change", Quantity::angular_momentum_change,
     "change of the angular momentum L about the origin, without external forces; divided by the largest |L| "
     "so far, or by S times the radius of the group"},
    {"quaternion_norm", Quantity::quaternion_norm, "largest | |q| − 1 |"},
    {"joint_error", Quantity::joint_error, "largest position error of the anchors of a joint"},
    {"joint_angle", Quantity::joint_angle, "largest angle between the axes of a hinge, or beyond its limits"},
    {"pairs", Quantity::pairs, "number of pairs of boxes that overlap"},
    {"touching", Quantity::touching, "number of pairs whose shapes touch"},
    {"speculative", Quantity::speculative, "number of contacts of the last step"},
    {"asleep", Quantity::asleep, "number of sleeping bodies"},
    {"tree_depth", Quantity::tree_depth, "levels of the tree of the broad phase; 0 without a tree"},
    {"difference", Quantity::difference,
     "largest distance of a body, minus `offset`, from the same body of another scene with the same "
     "settings"},
    {"separation_speed", Quantity::separation_speed,
     "separation speed of two bodies that overlapped at the start; along z if their centres coincide"},
    {"other_hash", Quantity::other_hash, "number of other runs that end in a different state"},
    {"found", Quantity::expected_finding, "1 if the guards report the expected finding"},
});
std::string_view unit_of(Quantity quantity);  ///< "m"; empty for a count or a share
/// Further members of its term, as Markdown: "`axis`, `body`".
std::string_view parameters_of(Quantity quantity);

/// A condition that must hold at every measured state from `from` to `to`. NaN fails.
struct Assertion {
  Quantity quantity = Quantity::finite;
  std::optional<double> at_most, at_least;  ///< in the quantity's unit; at least one is set
  std::optional<std::int64_t> from, to;     ///< states; unset: first and last state
  std::optional<std::uint32_t> body;        ///< unset: all bodies
  int axis = 0;                             ///< 0 to 2, for `position` and `velocity`
  std::int64_t since = 0;                   ///< reference state of `displacement`
  std::string scene{};                      ///< scene file compared with by `difference`
  Vector3d offset{0, 0, 0};                 ///< m, added to the compared bodies
  std::vector<LaunchShape> shapes{};        ///< launch shapes of the other runs of `other_hash`
  std::vector<std::string> broad_phases{};  ///< broad phases of the other runs of `other_hash`
  bool every_broad_phase = false;           ///< `other_hash` with every broad phase of the executor

  bool at(std::int64_t state) const { return state >= from.value_or(0) && (!to || state <= *to); }
};
/// "penetration at most 0.01 m, states 60 to 300".
std::string text_of(const Assertion& assertion);
/// `value` in the quantity's unit with three digits: "0.0123 m".
std::string text_of(Quantity quantity, double value);

/// A term that is known to fail, and the wider bounds within which it must stay.
struct ExpectedFailureTerm {
  std::size_t assertion = 0;                ///< index in `assertions`
  std::optional<double> at_most, at_least;  ///< in the quantity's unit; one for each bound that may fail
};
/// "penetration at most 0.1 m".
std::string text_of(const Assertion& assertion, const ExpectedFailureTerm& term);

/// Configurations in which the case is known to fail. An unset member matches any value. At least one of the
/// first three is set. All terms of `fails` must fail, and no others.
struct ExpectedFailure {
  std::optional<Solver> solver;
  std::optional<Precision> precision;
  std::optional<ExecutorKind> executor;  ///< cpu or cuda
  std::vector<ExpectedFailureTerm> fails;
  std::string why;  ///< reason, one line

  const ExpectedFailureTerm* term_of(std::size_t assertion) const;  ///< null if it must hold
};

/// State set on a body before a measurement. Unset members are unchanged. Any value is allowed, including
/// NaN.
struct InjectedState {
  std::int64_t step = 0;
  std::uint32_t body = 0;
  std::optional<Vector3d> position, velocity, angular_velocity;  ///< m, m/s, rad/s
  std::optional<Quaterniond> orientation;                        ///< not normalised
};

/// A fault that makes an assertion fail, as a proof that it can.
struct InjectedFault {
  std::size_t assertion = 0;  ///< index in `assertions`
  std::optional<InjectedState> state;
  std::optional<SettingsPatch> set;  ///< physical settings, set at the start
  std::string scene{};               ///< scene file used instead of the case's scene
};

/// The single finding that guards must report: step, stage and body.
struct ExpectedFinding {
  std::int64_t step = 0;
  std::string stage;
  std::uint32_t body = 0;
};

struct Criterion {
  std::string file;                   ///< source file
  std::vector<std::string> warnings;  ///< one line per old name in the file
  std::string what, group;            ///< one line; one of hard_case_groups
  std::int64_t steps = 0;
  std::optional<std::int64_t> long_steps;  ///< steps of the extended variant; unset: there is none
  std::int64_t every = 1;                  ///< measure every n-th state

  SettingsPatch run;  ///< run settings; unset ones come from the command line

  std::string changes;                  ///< change file, or empty
  std::vector<ExecutorKind> executors;  ///< supported executors; empty: all
  std::vector<Solver> solvers;          ///< solvers that the case is made for; empty: all
  /// The first assertion is always `finite`: all bodies are finite. A case with an expected finding has that
  /// finding as its only assertion.
  std::vector<Assertion> assertions;
  std::vector<ExpectedFailure> expected_failures;
  std::vector<InjectedFault> injected_faults;
  std::optional<ExpectedFinding> expected_finding;  ///< if set, the scene runs with guards, which pause there
  std::optional<InjectedState> injected_state;      ///< injected for the guards to detect
  /// Expected error lines: the scene must be rejected with this many lines, each containing the given text.
  /// If set, only `what` and `group` may be set in addition.
  std::vector<std::string> refused;

  const ExpectedFailure* expected_failure_of(Solver solver, Precision precision, ExecutorKind executor) const;
};

/// Headings of the case list, in order.
inline constexpr auto hard_case_groups =
    std::to_array<std::string_view>({"mass ratios", "stacks", "overlap", "speed", "distance", "time step",
                                     "rotation", "rest", "restitution and friction", "known answers",
                                     "wedges", "tree", "counts", "joints", "sleep", "settings", "bad input"});

/// Reads a criterion. `scene` is the case's scene, or null if it is invalid. Referenced files must be in the
/// same folder. Throws InputError with one line per fault: `file:line:column: message`.
Criterion read_criterion(const std::string& file, const Scene* scene);
/// Reads a criterion from text. `name` replaces the file name in messages.
Criterion parse_criterion(const std::string& text, const std::string& name, const Scene* scene);

}  // namespace collidoscope
