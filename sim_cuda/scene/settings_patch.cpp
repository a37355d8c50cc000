#include "sim_cuda/scene/settings_patch.h"

namespace collidoscope {

void apply(const SettingsPatch& patch, Scene& scene, RunOptions& run) {
  patch.for_each_set([&]<auto member>(const Field<member>&, const auto& value) {
    owner_in<typename Field<member>::Owner>(scene, run).*member = value;
  });
}

void apply(const SettingsPatch& patch, Scene& scene) {
  RunOptions unused;
  apply(patch, scene, unused);
}

void apply(const SettingsPatch& patch, RunSettings& all) {
  patch.for_each_set([&]<auto member>(const Field<member>&, const auto& value) {
    owner_in<typename Field<member>::Owner>(all).*member = value;
  });
}

SettingsPatch difference(const RunSettings& before, const RunSettings& after) {
  SettingsPatch patch;
  for_each_setting([&]<auto member>(const Field<member>& setting) {
    if (setting.live == Live::never) return;
    using Owner = typename Field<member>::Owner;
    const auto& value = owner_in<Owner>(after).*member;
    if (!(owner_in<Owner>(before).*member == value)) patch.set<member>(value);
  });
  return patch;
}

RunSettings settings_of(const Scene& scene, const RunOptions& run) {
  RunSettings all{.physics = scene.physics, .material = scene.materials.at(0), .generator = {}, .run = run};
  if (scene.generators.size() == 1) all.generator = scene.generators[0];
  return all;
}

bool equal_settings(const RunSettings& a, const RunSettings& b) {
  bool equal = true;
  for_each_setting([&]<auto member>(const Field<member>&) {
    using Owner = typename Field<member>::Owner;
    equal = equal && owner_in<Owner>(a).*member == owner_in<Owner>(b).*member;
  });
  return equal;
}

}  // namespace collidoscope
