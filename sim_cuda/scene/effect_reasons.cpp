#include "sim_cuda/scene/effect_reasons.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/placed_joint.h"

namespace collidoscope {
namespace {

EffectReason because(std::string why) { return {true, std::move(why), {}}; }
EffectReason not_since(std::string why) { return {false, std::move(why), {}}; }

std::string counted(std::size_t count, const char* one, const char* many) {
  return count == 1 ? fmt::format("one {}", one) : fmt::format("{} {}", count, many);
}

EffectReason of_materials(const Scene& scene, double Material::*value, const char* what) {
  for (const Material& material : scene.materials)
    if (material.*value != 0)
      return because(fmt::format("the material \"{}\" has {} {:g}", material.name, what, material.*value));
  return not_since("0 in all materials");
}

EffectReason of_friction(const Scene& scene) {
  EffectReason friction = of_materials(scene, &Material::friction, "friction");
  if (friction.required) return friction;
  if (of_materials(scene, &Material::rolling_resistance, "").required)
    return because("required by rolling resistance");
  return friction;
}

EffectReason of_rotation(const Scene& scene, const InitialBodies& bodies) {
  if (of_friction(scene).required) return because("friction applies torques");
  if (joints_turn_bodies(scene)) return because("a joint applies torques");
  if (std::ranges::any_of(bodies.angular_velocity, [](const Vector3d& spin) { return !spin.isZero(0); }))
    return because("a body has an initial spin");
  return not_since("no torques and no initial spin");
}

EffectReason of_drag(const Drag& medium) {
  if (medium.viscosity > 0)
    return because(fmt::format("the medium's viscosity is {:g} Pa s", medium.viscosity));
  if (medium.density * medium.coefficient > 0)
    return because(fmt::format("the medium's density is {:g} kg/m³", medium.density));
  return not_since("no medium");
}

EffectReason called(const Scene& scene, const InitialBodies& bodies, bool Effects::*flag) {
  const Physics& physics = scene.physics;
  if (flag == &Effects::gravity)
    return physics.gravity.isZero(0) ? not_since("gravity is 0")
                                     : because(fmt::format("gravity is {:.4g} m/s²", physics.gravity.norm()));
  if (flag == &Effects::attractor)
    return physics.attractors.empty()
               ? not_since("no attractors")
               : because(counted(physics.attractors.size(), "attractor", "attractors"));
  if (flag == &Effects::drag) return of_drag(physics.drag);
  if (flag == &Effects::rotation) return of_rotation(scene, bodies);
  if (flag == &Effects::friction) return of_friction(scene);
  if (flag == &Effects::rolling_resistance)
    return of_materials(scene, &Material::rolling_resistance, "rolling resistance");
  if (flag == &Effects::joints)
    return scene.joints.empty() ? not_since("no joints")
                                : because(counted(scene.joints.size(), "joint", "joints"));
  if (flag == &Effects::continuous_collision)
    return required_effects(scene, bodies).continuous_collision
               ? because("a body moves more than a radius per substep")
               : not_since("all start slowly");
  if (flag == &Effects::sleeping)
    return physics.sleep ? because(fmt::format("bodies below {:g} m/s for {:g} s sleep", physics.sleep->speed,
                                               physics.sleep->time))
                         : not_since("no \"sleep\" in the scene");
  if (flag == &Effects::guards)
    return physics.guards ? because(fmt::format("the scene's \"guards\" {} on failure",
                                                name_of(on_failure_names, physics.guards->on_failure)))
                          : not_since("no \"guards\" in the scene");
  return not_since("not required by the scene");
}

}  // namespace

EffectReason effect_reason(const Scene& scene, const InitialBodies& bodies, bool Effects::*flag) {
  EffectReason reason = called(scene, bodies, flag);
  // The same condition as in validate().
  const bool everywhere = flag == &Effects::gravity || flag == &Effects::drag || flag == &Effects::rotation ||
                          flag == &Effects::guards;
  if (scene.physics.solver == Solver::impulse && !everywhere) reason.cannot = "not supported by impulse";
  return reason;
}

}  // namespace collidoscope
