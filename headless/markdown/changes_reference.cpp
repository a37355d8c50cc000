#include "headless/markdown/field_cells.h"
#include "headless/markdown/reference_pages.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {
namespace {

std::string_view text_of_live(Live live) {
  switch (live) {
    case Live::in_place:
      return "next step";
    case Live::new_world:
      return "new World";
    case Live::restart:
      return "restarts at state 0";
    case Live::never:
      break;
  }
  return "";
}

template <auto member>
std::string meaning_in_changes(const Field<member>& setting) {
  std::string text = prose(setting.help);
  if constexpr (std::is_same_v<typename Field<member>::Owner, Material>)
    text += "; of the material `default`";
  if (!is_physical(setting)) text += "; never changes the result";
  return text;
}

}  // namespace

std::string changes_reference() {
  MarkdownTable table{"key", "unit", "range", "takes effect", "meaning"};
  table.row({"`step`", "", "whole, 0 or more; required", "", "state at which the change is applied"});
  for_each_setting([&](const auto& setting) {
    if (setting.live == Live::never) return;
    const std::string acts(text_of_live(setting.live));
    table.row({code(setting.name), unit_text(setting.unit), range_text(setting), acts,
               meaning_in_changes(setting)});
    if constexpr (std::is_same_v<typename std::decay_t<decltype(setting)>::Value, TimeStep>)
      table.row({"`steps_per_second`", "1/s",
                 "whole, " + detail::bounds_text(1, limits::max_steps_per_second), acts,
                 "instead of `time_step`"});
  });
  const std::string at_once(text_of_live(Live::new_world));
  table.row({"`remove`", "", "list of ids after the change of `bodies`, before this removal", at_once,
             "bodies to remove"});
  table.row({"`add`", "", "list, as `bodies` of a scene", at_once, "bodies to add; each gets the next id"});
  table.row({"`freeze`", "", "list of ids before the rest of this change", at_once,
             "dynamic bodies to make static, as guards do"});
  return table.text();
}

}  // namespace collidoscope
