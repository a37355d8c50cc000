#pragma once
// Name tables of the enumerations that scene.h does not cover, and messages about names.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/scene/named.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

inline constexpr std::array<Named<Shape>, 2> shape_names{
    {{"sphere", Shape::sphere}, {"mesh", Shape::mesh, "collides as its bounding sphere"}}};
inline constexpr std::array<Named<Motion>, 3> motion_names{
    {{"dynamic", Motion::dynamic, "forces move it"},
     {"kinematic", Motion::kinematic, "moves with the given velocity and spin"},
     {"static", Motion::fixed, "at rest"}}};
inline constexpr std::array<Named<OnFailure>, 2> on_failure_names{
    {{"pause", OnFailure::pause, "the run pauses at the state before the step"},
     {"freeze", OnFailure::freeze, "the step is repeated with the body fixed"}}};
inline constexpr std::array<Named<JointKind>, 4> joint_kind_names{
    {{"distance", JointKind::distance, "a rod, rope or strut between two points"},
     {"spring", JointKind::spring, "a spring and damper between two points"},
     {"ball", JointKind::ball, "one common point"},
     {"hinge", JointKind::hinge, "one common axis"}}};

// Options of a run: core/executor_options.h.
inline constexpr std::array<Named<ExecutorKind>, 3> executor_names{
    {{"auto", ExecutorKind::automatic, "CUDA if a device is available, else the CPU"},
     {"cpu", ExecutorKind::cpu},
     {"cuda", ExecutorKind::cuda}}};
inline constexpr std::array<Named<LaneOrder>, 3> lane_order_names{
    {{"contiguous", LaneOrder::contiguous, "each lane processes one range of items"},
     {"strided", LaneOrder::strided, "a test mode"},
     {"shuffled", LaneOrder::shuffled, "a test mode"}}};
inline constexpr std::array<Named<PairComparison>, 2> pair_comparison_names{
    {{"off", PairComparison::off, "pairs are not compared"},
     {"on", PairComparison::on, "in each step, with those of lbvh_ropes"}}};
inline constexpr std::array<Named<SortMethod>, 3> sort_names{
    {{"auto", SortMethod::automatic, "counting sort by cell up to 2^21 bodies, else library"},
     {"library", SortMethod::library, "CUB radix sort, or the sort of the CPU"},
     {"radix", SortMethod::radix, "radix sort of Harada and Howes 2011; its launches use (B, T)"}}};
inline constexpr std::array<Named<int>, 4> key_bits_names{{{"auto", 0}, {"24", 24}, {"30", 30}, {"63", 63}}};

/// An effect and its flag. The texts are Markdown.
struct EffectName {
  std::string_view name;
  bool Effects::*flag;
  std::string_view needed_where;  ///< condition under which "auto" switches it on
  std::string_view needs;         ///< required effects and solvers
  std::string_view what;          ///< description
};
std::vector<std::string> names_of(Effects effects);
inline constexpr auto effect_names = std::to_array<EffectName>({
    {"gravity", &Effects::gravity, "`gravity` is not 0", "", "v += h·g"},
    {"attractor", &Effects::attractor, "the scene has `attractors`", "not `impulse`",
     "acceleration −μ·d/(|d|² + ε²)^(3/2) by each point (Newton's law with Plummer softening)"},
    {"drag", &Effects::drag, "the medium has `viscosity`, or `density` and `coefficient`", "",
     "F = −6πη·r·v − ½ρ·C·π·r²·|v|·v; spin is not damped"},
    {"rotation", &Effects::rotation, "a body has an initial spin, a joint applies torques, or friction is on",
     "", "stores and integrates orientation and spin"},
    {"friction", &Effects::friction, "a material has `friction` or `rolling_resistance`",
     "`rotation`; not `impulse`", "Coulomb friction"},
    {"rolling_resistance", &Effects::rolling_resistance, "a material has `rolling_resistance`",
     "`rotation`, `friction`; not `impulse`", "a torque against relative spin, at most c·R·N"},
    {"joints", &Effects::joints, "the scene has `joints`", "`rotation` if they apply torques; not `impulse`",
     "distance, spring, ball and hinge joints"},
    {"continuous_collision", &Effects::continuous_collision,
     "a body initially moves more than the smallest radius per substep", "not `impulse`",
     "prevents tunnelling: no two bodies pass through each other"},
    {"sleeping", &Effects::sleeping, "the scene has `sleep`", "not `impulse`",
     "islands at rest are neither solved nor moved"},
    {"guards", &Effects::guards, "the scene has `guards`", "",
     "checks the output of each stage; does not change the state"},
});

/// A list for messages: "paper, scaled, settled or equal".
std::string either_of(std::span<const std::string_view> names);

/// The most similar name for a spelling suggestion. Empty if none is within an edit distance of a third of
/// the length of `word`, or of 1 for short words.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names);

/// Message for an unknown name: `unknown solver "foo"; expected "impulse"`, or `unknown variant "papr";
/// did you mean "paper"? (paper, scaled, settled or equal)`.
std::string unknown_name(std::string_view what, std::string_view word,
                         std::span<const std::string_view> names);

/// Shortens `word` to at most `longest` bytes for a message. Replaces control characters with '?'.
std::string printable(std::string_view word, std::size_t longest = 60);

}  // namespace collidoscope
