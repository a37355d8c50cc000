#pragma once
// Text fields for numbers. An invalid input leaves the value unchanged and is reported below the field, with
// the allowed range. Free functions, between ImGui::NewFrame() and Render().

#include <cstdint>
#include <string>
#include <string_view>

#include "ui/workspace.h"

namespace collidoscope {

/// Closed range of a field. The limits come from sim_cuda/scene/limits.h.
template <class Number>
struct NumberRange {
  Number low{}, high{};
  const char* unit = "";      ///< optional suffix of the input
  bool zero_is_auto = false;  ///< "auto" and 0 are accepted and set 0
};

/// Parses `text` as std::int64_t, std::uint64_t or double. Sets `value` and returns "". On failure returns
/// the fault with the allowed range and leaves `value` unchanged.
template <class Number>
std::string read_number(std::string_view text, const NumberRange<Number>& range, Number& value);

/// A field of the current item width, tracked as `name`. `format` is an fmt format for the value. The input
/// is applied on Return and on loss of focus. Returns whether the value changed. `label` starts the text of a
/// fault.
template <class Number>
bool number_field(Workspace& workspace, const char* name, const char* label, Number& value,
                  const NumberRange<Number>& range, const char* format);

/// Shows the fault of the last input into the field `name`, if any, below its row.
void draw_input_fault(Workspace& workspace, const char* name);

}  // namespace collidoscope
