#pragma once
// Reads a subset of the settings from a JSON object in a change file or a criterion.

#include "sim_cuda/scene/field_reader.h"
#include "sim_cuda/scene/settings_patch.h"

namespace collidoscope {

/// Reads the settings for which use(field) is true. Faults are appended to the Reading. validate() checks the
/// ranges of physical settings.
template <class Use>
void read_patch(Reading& reading, ObjectReader& reader, SettingsPatch& patch, const Use& use) {
  for_each_setting([&]<auto member>(const Field<member>& setting) {
    typename Field<member>::Value value{};
    if (use(setting) && read_value(reading, reader, setting.name, setting, value))
      patch.set<member>(std::move(value));
  });
}

}  // namespace collidoscope
