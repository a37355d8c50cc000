#pragma once
// Reading some of the settings from an object of JSON, by their names: in a file of changes, or in a
// criterion.

#include "sim_cuda/scene/field_reader.h"
#include "sim_cuda/scene/settings_patch.h"

namespace collidoscope {

/// Reads the settings for which use(field) is true. Faults go to the Reading; ranges of physical settings are
/// validate()'s business.
template <class Use>
void read_patch(Reading& reading, ObjectReader& reader, SettingsPatch& patch, const Use& use) {
  for_each_setting([&]<auto member>(const Field<member>& setting) {
    typename Field<member>::Value value{};
    if (use(setting) && read_value(reading, reader, setting.name, setting, value))
      patch.set<member>(std::move(value));
  });
}

}  // namespace collidoscope
