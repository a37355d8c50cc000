#pragma once
// The criterion of a hard case: what must hold of its scene, how long, where it is known not to hold, and
// faults that show that the criterion can fail. Plain data, and the reading of the file that says it: JSON
// with comments, `"format": "collidoscope-criterion", "version": 1`. README.md of this folder lists
// what it may hold.

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

/// What can be measured; quantities.h says how.
enum class Quantity {
  finite,
  penetration,
  penetration_over_radius,
  speed,
  spin,
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
    {"speed", Quantity::speed, "of the fastest body"},
    {"spin", Quantity::spin, "of the fastest body"},
    {"energy_gain", Quantity::energy_gain,
     "(E − E₀ − W)/S: E kinetic and potential energy, W the work of the positional push, S the largest "
     "kinetic energy plus |change of potential energy| so far; 0 if both are 0"},
    {"energy_loss", Quantity::energy_loss, "−`energy_gain`"},
    {"kinetic_energy", Quantity::kinetic_energy, "of the dynamic bodies"},
    {"escaped", Quantity::escaped, "number of bodies whose centres are outside the box"},
    {"displacement", Quantity::displacement, "largest distance of a body from its place at state `since`"},
    {"position", Quantity::position, "along the axis"},
    {"velocity", Quantity::velocity, "along the axis"},
    {"momentum_change", Quantity::momentum_change,
     "|p − p₀ − J − m·g·t|/S: the change that neither the walls' impulse J nor gravity explains; S the "
     "largest "
     "sum of m·|v| so far"},
    {"angular_momentum_change", Quantity::angular_momentum_change,
     "about the origin, where nothing acts from outside; over the largest |L| so far, or the sum of m·|v| "
     "times the radius of the group"},
    {"quaternion_norm", Quantity::quaternion_norm, "largest | |q| − 1 |"},
    {"joint_error", Quantity::joint_error, "largest: anchors too far apart, or too near"},
    {"joint_angle", Quantity::joint_angle, "largest: between the axes of a hinge, or beyond its limits"},
    {"pairs", Quantity::pairs, "number of pairs of boxes that overlap"},
    {"touching", Quantity::touching, "number of pairs whose shapes touch"},
    {"speculative", Quantity::speculative, "number of contacts of the last step"},
    {"asleep", Quantity::asleep, "number of bodies that sleep"},
    {"tree_depth", Quantity::tree_depth, "levels of the tree of the broad phase; 0 without a tree"},
    {"difference", Quantity::difference,
     "largest distance of a body, minus `offset`, from the same body of another scene with the same "
     "settings"},
    {"separation_speed", Quantity::separation_speed,
     "of two bodies that overlapped at the start; along z where their centres coincide"},
    {"other_hash", Quantity::other_hash, "number of other runs that reach another state"},
    {"found", Quantity::expected_finding, "the guards find what they must"},
});
std::string_view unit_of(Quantity quantity);  ///< "m"; empty for a count or a share
/// Further members of its term, as Markdown: "`axis`, `body`".
std::string_view parameters_of(Quantity quantity);

/// One thing that must hold at all states that are measured from `from` to `to`. NaN never holds.
struct Assertion {
  Quantity quantity = Quantity::finite;
  std::optional<double> at_most, at_least;  ///< in the quantity's unit; at least one of them
  std::optional<std::int64_t> from, to;     ///< states; unset: from the first, to the last
  std::optional<std::uint32_t> body;        ///< unset: all of them
  int axis = 0;                             ///< 0 to 2, of `position` and `velocity`
  std::int64_t since = 0;                   ///< state that `displacement` counts from
  std::string scene{};                      ///< file, whose bodies `difference` compares with
  Vector3d offset{0, 0, 0};                 ///< m, from its bodies to these
  std::vector<LaunchShape> shapes{};        ///< of the other runs of `other_hash`
  std::vector<std::string> broad_phases{};  ///< the same
  bool every_broad_phase = false;           ///< the same, with all that the executor has

  bool at(std::int64_t state) const { return state >= from.value_or(0) && (!to || state <= *to); }
};
/// "penetration at most 0.01 m, states 60 to 300".
std::string text_of(const Assertion& assertion);
/// `value` in the quantity's unit, three digits: "0.0123 m".
std::string text_of(Quantity quantity, double value);

/// Where the case is known not to hold; what is unset is any. At least one of the three is set.
struct ExpectedFailure {
  std::optional<Solver> solver;
  std::optional<Precision> precision;
  std::optional<ExecutorKind> executor;  ///< cpu or cuda
  std::string why;                       ///< a line
};

/// What a body is set to at a state, before it is measured there; unset: as it was. Anything goes, NaN too.
struct InjectedState {
  std::int64_t step = 0;
  std::uint32_t body = 0;
  std::optional<Vector3d> position, velocity, angular_velocity;  ///< m, m/s, rad/s
  std::optional<Quaterniond> orientation;                        ///< as it is, of any length
};

/// What makes an assertion fail, as a proof that it can.
struct InjectedFault {
  std::size_t assertion = 0;  ///< its place in `assertions`
  std::optional<InjectedState> state;
  std::optional<SettingsPatch> set;  ///< physical ones, from the start on
  std::string scene{};               ///< file, in place of the case's own
};

/// What guards must find, and no other: in which step, after which stage, of which body.
struct ExpectedFinding {
  std::int64_t step = 0;
  std::string stage;
  std::uint32_t body = 0;
};

struct Criterion {
  std::string file;         ///< that it was read from
  std::string what, group;  ///< a line; one of hard_case_groups
  std::int64_t steps = 0;
  std::optional<std::int64_t> long_steps;  ///< of the long variant; unset: it has none
  std::int64_t every = 1;                  ///< states between two that are measured

  SettingsPatch run;  ///< how it runs; what it leaves out is as the command line has it

  std::string changes;                  ///< file, or empty
  std::vector<ExecutorKind> executors;  ///< it runs on these alone; empty: on all
  /// The first is always `finite`: no body that is not. Of a case whose guards must find something, that they
  /// do is the only one.
  std::vector<Assertion> assertions;
  std::vector<ExpectedFailure> expected_failures;
  std::vector<InjectedFault> injected_faults;
  std::optional<ExpectedFinding> expected_finding;  ///< the scene runs with guards, which pause there
  std::optional<InjectedState> injected_state;      ///< for them to find
  /// The scene must be refused with so many lines, each with these words. Not empty: nothing else is set but
  /// `what` and `group`.
  std::vector<std::string> refused;

  const ExpectedFailure* expected_failure_of(Solver solver, Precision precision, ExecutorKind executor) const;
};

/// The headings under which cases are listed, in order.
inline constexpr auto hard_case_groups = std::to_array<std::string_view>(
    {"mass ratios", "stacks", "overlap", "speed", "distance", "time step", "rotation", "rest",
     "restitution and friction", "wedges", "tree", "counts", "joints", "sleep", "settings", "bad input"});

/// `scene` is the case's, null where it cannot be read. Files that it names lie beside it. Throws InputError
/// with one line per fault, `file:line:column: what, and what would be right`.
Criterion read_criterion(const std::string& file, const Scene* scene);
/// The same from text; `name` stands where the file would.
Criterion parse_criterion(const std::string& text, const std::string& name, const Scene* scene);

}  // namespace collidoscope
