#pragma once
// Name tables of the enumerations that scene.h does not cover, and messages about names.

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/scene/named.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

inline constexpr std::array<Named<Shape>, 2> shape_names{{{"sphere", Shape::sphere}, {"mesh", Shape::mesh}}};
inline constexpr std::array<Named<Motion>, 3> motion_names{
    {{"dynamic", Motion::dynamic}, {"kinematic", Motion::kinematic}, {"static", Motion::fixed}}};
inline constexpr std::array<Named<OnFailure>, 2> on_failure_names{
    {{"pause", OnFailure::pause}, {"freeze", OnFailure::freeze}}};
inline constexpr std::array<Named<JointKind>, 4> joint_kind_names{{{"distance", JointKind::distance},
                                                                   {"spring", JointKind::spring},
                                                                   {"ball", JointKind::ball},
                                                                   {"hinge", JointKind::hinge}}};

// Options of a run: core/executor_options.h.
inline constexpr std::array<Named<ExecutorKind>, 3> executor_names{
    {{"auto", ExecutorKind::automatic, "CUDA if there is a device, else the CPU"},
     {"cpu", ExecutorKind::cpu},
     {"cuda", ExecutorKind::cuda}}};
inline constexpr std::array<Named<LaneOrder>, 3> lane_order_names{
    {{"contiguous", LaneOrder::contiguous, "each lane takes one range of items"},
     {"strided", LaneOrder::strided, "a test mode"},
     {"shuffled", LaneOrder::shuffled, "a test mode"}}};
inline constexpr std::array<Named<SortMethod>, 3> sort_names{
    {{"auto", SortMethod::automatic, "counting in cells for few bodies, else the library"},
     {"library", SortMethod::library},
     {"radix", SortMethod::radix, "obeys (B, T)"}}};
inline constexpr std::array<Named<int>, 4> key_bits_names{{{"auto", 0}, {"24", 24}, {"30", 30}, {"63", 63}}};

/// An effect and its flag.
struct EffectName {
  std::string_view name;
  bool Effects::*flag;
};
inline constexpr auto effect_names = std::to_array<EffectName>({
    {"gravity", &Effects::gravity},
    {"attractor", &Effects::attractor},
    {"drag", &Effects::drag},
    {"rotation", &Effects::rotation},
    {"friction", &Effects::friction},
    {"rolling_resistance", &Effects::rolling_resistance},
    {"joints", &Effects::joints},
    {"continuous_collision", &Effects::continuous_collision},
    {"sleeping", &Effects::sleeping},
    {"guards", &Effects::guards},
});

/// A list for messages: "paper, scaled, settled or equal".
std::string either_of(std::span<const std::string_view> names);

/// The most similar name for a spelling suggestion. Empty if none is within an edit distance of a third of
/// the length of `word`, or of 1 for short words.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names);

/// Message for an unknown name: `unknown solver "foo"; impulse is the only one`, or `unknown variant "papr";
/// did you mean "paper"? (paper, scaled, settled or equal)`.
std::string unknown_name(std::string_view what, std::string_view word,
                         std::span<const std::string_view> names);

/// Shortens `word` to at most `longest` bytes for a message. Replaces control characters with '?'.
std::string printable(std::string_view word, std::size_t longest = 60);

}  // namespace collidoscope
