#pragma once
// Fields to type numbers into. What cannot be used leaves the value as it is, and is reported below the field
// with the range that is allowed. Free functions, between ImGui::NewFrame() and Render().

#include <cstdint>
#include <string>
#include <string_view>

#include "ui/workspace.h"

namespace collidoscope {

/// Which numbers a field takes, both ends included. The ends are those of sim_cuda/scene/limits.h.
template <class Number>
struct NumberRange {
  Number low{}, high{};
  const char* unit = "";      ///< may follow the number
  bool zero_is_auto = false;  ///< "auto" and 0 are taken as well, and give 0
};

/// The number in `text`: std::int64_t, std::uint64_t (whole) or double. Returns "" and sets `value`, or
/// returns what is wrong and which range is allowed, and leaves `value`.
template <class Number>
std::string read_number(std::string_view text, const NumberRange<Number>& range, Number& value);

/// A field of the current item width, tracked as `name`; `format` is fmt's, for the value that is shown.
/// A new number is taken with Return, and when the field loses the keyboard. Returns whether there is one.
/// `label` begins a report.
template <class Number>
bool number_field(Workspace& workspace, const char* name, const char* label, Number& value,
                  const NumberRange<Number>& range, const char* format);

/// The report on what was typed into a field of this name, if there is one; below its row.
void draw_input_fault(Workspace& workspace, const char* name);

}  // namespace collidoscope
