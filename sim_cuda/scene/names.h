#pragma once
// The names of choices, as scene files, command lines and reports write them: one table per enumeration.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

template <class Choice>
struct Named {
  std::string_view name;
  Choice value;
};

inline constexpr std::array<Named<Precision>, 2> precision_names{
    {{"f32", Precision::f32}, {"f64", Precision::f64}}};
inline constexpr std::array<Named<Solver>, 3> solver_names{
    {{"impulse", Solver::impulse}, {"soft_step", Solver::soft_step}, {"jacobi_split", Solver::jacobi_split}}};
inline constexpr std::array<Named<Integrator>, 3> integrator_names{
    {{"semi_implicit_euler", Integrator::semi_implicit_euler},
     {"velocity_verlet", Integrator::velocity_verlet},
     {"rk4", Integrator::rk4}}};
inline constexpr std::array<Named<RotationUpdate>, 2> rotation_update_names{
    {{"first_order", RotationUpdate::first_order}, {"lie_group", RotationUpdate::lie_group}}};
inline constexpr std::array<Named<Shape>, 2> shape_names{{{"sphere", Shape::sphere}, {"mesh", Shape::mesh}}};
inline constexpr std::array<Named<Motion>, 3> motion_names{
    {{"dynamic", Motion::dynamic}, {"kinematic", Motion::kinematic}, {"static", Motion::fixed}}};
inline constexpr std::array<Named<Variant>, 4> variant_names{{{"paper", Variant::paper},
                                                              {"scaled", Variant::scaled},
                                                              {"settled", Variant::settled},
                                                              {"equal", Variant::equal}}};
inline constexpr std::array<Named<OnFailure>, 2> on_failure_names{
    {{"pause", OnFailure::pause}, {"freeze", OnFailure::freeze}}};
inline constexpr std::array<Named<Spawn>, 3> spawn_names{
    {{"inside", Spawn::inside}, {"centres", Spawn::centres}, {"apart", Spawn::apart}}};
inline constexpr std::array<Named<JointKind>, 4> joint_kind_names{{{"distance", JointKind::distance},
                                                                   {"spring", JointKind::spring},
                                                                   {"ball", JointKind::ball},
                                                                   {"hinge", JointKind::hinge}}};

/// Every effect, which is on or off.
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

/// The name of a value that is in the table; "?" for one that is not.
template <class Choice, std::size_t count>
constexpr std::string_view name_of(const std::array<Named<Choice>, count>& table, Choice value) {
  for (const Named<Choice>& entry : table) {
    if (entry.value == value) return entry.name;
  }
  return "?";
}

/// The value of a name; none where the table does not know it.
template <class Choice, std::size_t count>
constexpr std::optional<Choice> value_of(const std::array<Named<Choice>, count>& table,
                                         std::string_view name) {
  for (const Named<Choice>& entry : table) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

/// All names of a table (of Named or EffectName) in order.
template <class Table>
std::vector<std::string_view> names_in(const Table& table) {
  std::vector<std::string_view> names;
  for (const auto& entry : table) names.push_back(entry.name);
  return names;
}

/// "paper, scaled, settled or equal".
std::string either_of(std::span<const std::string_view> names);

/// The name that `word` was probably meant to be: fewest single-letter edits, at most a third of its length
/// (but always one); empty where none is near.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names);

/// What is wrong with a name that is not in the list: `unknown solver "foo"; impulse is the only one`, or
/// `unknown variant "papr"; did you mean "paper"? (paper, scaled, settled or equal)`.
std::string unknown_name(std::string_view what, std::string_view word,
                         std::span<const std::string_view> names);

/// `word` for a message: at most `longest` bytes of it, control characters replaced by '?'.
std::string printable(std::string_view word, std::size_t longest = 60);

}  // namespace collidoscope
