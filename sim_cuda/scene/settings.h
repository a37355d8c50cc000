#pragma once
// The settings of a run in one table: name, member, unit, range, default, help and live behaviour.
// Scene files, change files, flags, the settings panel, criteria and generated documents iterate over it
// (for_each_setting). A new setting needs a member in scene.h or in the options, and a row
// here.
//
// Physics, Material and BoxCollider affect the state. RunOptions affects only how the state is computed.

#include <tuple>

#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/field.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Settings at the top level of a scene.
inline constexpr auto physics_settings = std::tuple{
    Field<&Physics::gravity>{.key = "gravity",
                             .help = "acceleration of all bodies",
                             .unit = "m/s^2",
                             .low = -limits::max_gravity,
                             .high = limits::max_gravity,
                             .placeholder = "X,Y,Z",
                             .live = Live::new_world},
    Field<&Physics::time_step>{.key = "time_step",
                               .help = "duration of a step",
                               .unit = "s",
                               .low = limits::min_time_step,
                               .high = limits::max_time_step,
                               .label = "step rate",
                               .placeholder = "S",
                               .live = Live::new_world},
    Field<&Physics::substeps>{
        .key = "substeps",
        .help = "equal parts of a step; auto: 1 with impulse, else 4, or up to 64 if joints need more",
        .low = 1,
        .high = limits::max_substeps,
        .automatic = Auto::unset,
        .placeholder = "K",
        .live = Live::new_world,
        .slider_high = 32},
    Field<&Physics::iterations>{.key = "iterations",
                                .help = "solver iterations over all contacts, in each substep",
                                .low = 1,
                                .high = limits::max_iterations,
                                .placeholder = "I",
                                .live = Live::new_world,
                                .slider_high = 32},
    Field<&Physics::solver>{.key = "solver",
                            .help = "contact solver",
                            .choices = solver_names,
                            .placeholder = "NAME",
                            .live = Live::new_world,
                            .for_stability = true},
    Field<&Physics::integrator>{
        .key = "integrator",
        .help = "integrator of bodies without contacts; bodies with contacts use semi_implicit_euler",
        .choices = integrator_names,
        .placeholder = "NAME",
        .live = Live::new_world},
    Field<&Physics::rotation_update>{.key = "rotation_update",
                                     .help = "integration of rotation",
                                     .choices = rotation_update_names,
                                     .label = "rotation",
                                     .placeholder = "NAME",
                                     .live = Live::new_world},
    Field<&Physics::precision>{.key = "precision",
                               .help = "floating-point precision of the whole simulation",
                               .choices = precision_names,
                               .placeholder = "NAME",
                               .live = Live::new_world,
                               .for_stability = true},
    Field<&Physics::effects>{.key = "effects",
                             .help = "enabled effects; auto: those that the scene requires",
                             .automatic = Auto::unset,
                             .placeholder = "LIST",
                             .live = Live::new_world},
    Field<&Physics::restitution_threshold>{
        .key = "restitution_threshold",
        .help = "contacts with a lower approach speed do not bounce; auto: 2 |gravity| time_step / substeps",
        .unit = "m/s",
        .low = 0,
        .high = limits::max_speed,
        .automatic = Auto::unset,
        .placeholder = "V",
        .live = Live::new_world},
};

/// Settings of each material. Flags and panels set the material "default".
inline constexpr auto material_settings = std::tuple{
    Field<&Material::density>{.key = "density",
                              .help = "mass per volume",
                              .unit = "kg/m^3",
                              .low = limits::min_density,
                              .high = limits::max_density,
                              .placeholder = "D",
                              .live = Live::never},
    Field<&Material::restitution>{.key = "restitution",
                                  .help = "0: no bounce, 1: elastic; a pair uses the larger one",
                                  .low = 0,
                                  .high = limits::max_restitution,
                                  .placeholder = "E",
                                  .live = Live::new_world},
    Field<&Material::friction>{
        .key = "friction",
        .help = "Coulomb friction coefficient; a pair uses the geometric mean; not with impulse",
        .low = 0,
        .high = limits::max_friction,
        .placeholder = "MU",
        .live = Live::new_world},
    Field<&Material::rolling_resistance>{.key = "rolling_resistance",
                                         .help = "lever arm of the normal force divided by the radius; a "
                                                 "pair uses the larger one; not with impulse",
                                         .low = 0,
                                         .high = limits::max_rolling_resistance,
                                         .placeholder = "C",
                                         .live = Live::new_world},
};

/// Settings of each generator. Flags and panels set a scene's only generator.
inline constexpr auto generator_settings = std::tuple{
    Field<&BoxCollider::count>{.key = "count",
                               .help = "number of bodies of the scene's generator",
                               .low = 0,
                               .high = limits::max_bodies,
                               .name = "bodies",
                               .label = "N",
                               .placeholder = "N",
                               .live = Live::new_world,
                               .slider_high = 2'000'000},
    Field<&BoxCollider::radius_max>{.key = "radius_max",
                                    .help = "largest radius of generated spheres; must fit in the box",
                                    .unit = "m",
                                    .low = limits::min_generated_radius,
                                    .high = limits::max_radius,
                                    .label = "max radius",
                                    .placeholder = "R",
                                    .live = Live::restart},
    Field<&BoxCollider::radii>{.key = "radii",
                               .help = "distribution of the generated radii",
                               .choices = radii_names,
                               .placeholder = "NAME",
                               .live = Live::restart},
    Field<&BoxCollider::variant>{
        .key = "variant",
        .help = "how the generator's box and radii depend on N; at most one generator is not \"paper\"",
        .choices = variant_names,
        .placeholder = "NAME",
        .live = Live::restart},
    Field<&BoxCollider::spawn>{.key = "spawn",
                               .help = "where generated bodies start",
                               .choices = spawn_names,
                               .placeholder = "NAME",
                               .live = Live::restart},
    Field<&BoxCollider::seed>{
        .key = "seed", .help = "seed of the generator", .placeholder = "S", .live = Live::restart},
    Field<&BoxCollider::speed_max>{.key = "speed_max",
                                   .help = "each velocity component is uniform in [-speed_max, speed_max)",
                                   .unit = "m/s",
                                   .low = 0,
                                   .high = limits::max_speed,
                                   .placeholder = "V",
                                   .live = Live::restart},
};

/// Settings of a run. They do not affect the state.
inline constexpr auto shape_settings = std::tuple{
    Field<&LaunchShape::blocks>{
        .key = "blocks",
        .help = "blocks per launch: exactly B*T threads (lanes on the CPU) process each stage",
        .low = 1,
        .high = limits::max_blocks,
        .automatic = Auto::zero,
        .label = "B",
        .placeholder = "B",
        .live = Live::in_place,
        .slider_high = 65536},
    Field<&LaunchShape::threads>{.key = "threads",
                                 .help = "threads per block",
                                 .low = 1,
                                 .high = limits::max_threads,
                                 .automatic = Auto::zero,
                                 .label = "T",
                                 .placeholder = "T",
                                 .live = Live::in_place,
                                 .slider_high = limits::max_threads},
};
inline constexpr auto run_settings = std::tuple{
    Field<&RunOptions::broad_phase>{
        .key = "broad_phase",
        .help = "method that finds pairs of overlapping boxes, or the path of a plug-in",
        .words = broad_phase_names,
        .label = "broad phase",
        .placeholder = "NAME",
        .live = Live::new_world},
    Field<&RunOptions::initial_pair_capacity>{
        .key = "initial_pair_capacity",
        .help = "initial capacity of the pair list in pairs, or auto; the list grows if needed",
        .low = 1,
        .high = 0x1p40,
        .automatic = Auto::zero},
};
inline constexpr auto executor_settings = std::tuple{
    Field<&ExecutorOptions::executor>{.key = "executor",
                                      .help = "device that runs the stages",
                                      .choices = executor_names,
                                      .placeholder = "NAME",
                                      .for_stability = true},
    Field<&ExecutorOptions::gpu>{.key = "gpu",
                                 .help = "CUDA device number",
                                 .low = 0,
                                 .high = 1023,
                                 .placeholder = "I",
                                 .for_stability = true},
    Field<&ExecutorOptions::cpu_threads>{.key = "cpu_threads",
                                         .help = "CPU threads that run the B*T lanes",
                                         .low = 1,
                                         .high = 1024,
                                         .automatic = Auto::zero},
    Field<&ExecutorOptions::lane_order>{.key = "lane_order",
                                        .help = "assignment of items to the lanes of the CPU",
                                        .choices = lane_order_names,
                                        .placeholder = "NAME"},
    Field<&ExecutorOptions::key_bits>{.key = "key_bits",
                                      .help = "bits of a Morton key; auto: more for crowded scenes",
                                      .automatic = Auto::zero,
                                      .choices = key_bits_names,
                                      .placeholder = "K"},
    Field<&ExecutorOptions::check_pairs>{.key = "check_pairs",
                                         .help = "comparison of the pairs of a plug-in",
                                         .choices = pair_comparison_names,
                                         .label = "check pairs",
                                         .placeholder = "NAME",
                                         .live = Live::new_world},
    Field<&ExecutorOptions::sort>{
        .key = "sort", .help = "sort method for keys", .choices = sort_names, .placeholder = "NAME"},
    Field<&ExecutorOptions::memory_limit>{
        .key = "memory_limit",
        .help = "maximum device memory; auto: all available memory; a run that needs more stops without loss "
                "of data and reports the number of bytes",
        .unit = "bytes",
        .low = 1,
        .high = 0x1p50,
        .automatic = Auto::zero,
        .placeholder = "BYTES"},
};

/// All settings. Physical settings come first.
inline constexpr auto all_settings = std::tuple_cat(physics_settings, material_settings, generator_settings,
                                                    shape_settings, run_settings, executor_settings);
inline constexpr std::size_t setting_count = std::tuple_size_v<decltype(all_settings)>;

/// The table row of a member.
template <auto member>
inline constexpr const Field<member>& field_of = std::get<Field<member>>(all_settings);

template <class Use>
constexpr void for_each_setting(Use&& use) {
  for_each_field(all_settings, use);
}

/// True if the setting affects the state.
template <auto member>
constexpr bool is_physical(const Field<member>&) {
  using Owner = typename Field<member>::Owner;
  return std::is_same_v<Owner, Physics> || std::is_same_v<Owner, Material> ||
         std::is_same_v<Owner, BoxCollider>;
}
template <auto member>
constexpr bool is_of_generator(const Field<member>&) {
  return std::is_same_v<typename Field<member>::Owner, BoxCollider>;
}

/// The path of the setting's value in a scene, in the form of Fault::path: "generators[0].count". Physical
/// settings only.
template <auto member>
std::string path_of(const Field<member>& setting) {
  using Owner = typename Field<member>::Owner;
  const std::string key(setting.key);
  if constexpr (std::is_same_v<Owner, Material>) return "materials.default." + key;
  if constexpr (std::is_same_v<Owner, BoxCollider>) return "generators[0]." + key;
  return key;
}

/// Values of all settings.
struct RunSettings {
  Physics physics;
  Material material;      ///< the material "default"
  BoxCollider generator;  ///< the scene's only generator
  RunOptions run;
};

/// The struct that contains a setting of type Owner.
template <class Owner>
Owner& owner_in(RunSettings& all) {
  if constexpr (std::is_same_v<Owner, Physics>)
    return all.physics;
  else if constexpr (std::is_same_v<Owner, Material>)
    return all.material;
  else if constexpr (std::is_same_v<Owner, BoxCollider>)
    return all.generator;
  else if constexpr (std::is_same_v<Owner, LaunchShape>)
    return all.run.shape;
  else
    return all.run;
}
template <class Owner>
const Owner& owner_in(const RunSettings& all) {
  return owner_in<Owner>(const_cast<RunSettings&>(all));
}
/// The struct that contains a setting of type Owner. If Owner is BoxCollider, the scene must have a
/// generator; the first one is used.
template <class Owner>
Owner& owner_in(Scene& scene, RunOptions& run) {
  if constexpr (std::is_same_v<Owner, Physics>)
    return scene.physics;
  else if constexpr (std::is_same_v<Owner, Material>)
    return scene.materials.at(0);
  else if constexpr (std::is_same_v<Owner, BoxCollider>)
    return scene.generators.at(0);
  else if constexpr (std::is_same_v<Owner, LaunchShape>)
    return run.shape;
  else
    return run;
}

}  // namespace collidoscope
