#pragma once
// Building blocks of panels: named rows, widget positions for --automation, number formats. Free functions,
// between ImGui::NewFrame() and Render().

#include <cstdint>
#include <string>
#include <string_view>

#include "ui/workspace.h"

namespace collidoscope {

/// Records the position of the last widget if it is visible and enabled.
void track(Workspace& workspace, const char* name);
void track(Workspace& workspace, const char* name, const ScreenRect& rect);

/// Header of a foldable panel. Returns whether the panel is open. Always call end_panel() afterwards.
bool begin_panel(Workspace& workspace, const char* name, const char* title, bool& open);
void end_panel();

/// Draws the label of a row. The next widget is the value and takes the remaining width.
void row_label(const char* label, const char* help = nullptr);
/// A row with label and text.
void row_text(const char* label, const std::string& value, const char* help = nullptr);
/// Two label-text pairs per row: each call draws the next half.
class TextPairs {
 public:
  void operator()(const char* label, const std::string& value, const char* help = nullptr);

 private:
  bool second_ = false;
};
/// Right-aligned text in a table cell.
void number_cell(const std::string& text);
/// A drop-down list that shows `chosen`; Escape closes it. If it returns true, draw the choices and call
/// ImGui::EndCombo().
bool begin_choice(const char* id, const char* chosen);
/// Tooltip of the last widget.
void explain(const char* text);
/// Text in the theme's faint colour.
void faint_text(const std::string& text);

/// Thousands separators: "1,234,567".
std::string grouped_number(std::int64_t number);
/// Milliseconds with three to five digits: "12.30".
std::string short_time(double ms);
/// SI prefix and unit: 1.23e+06 J is "1.23 MJ".
std::string with_prefix(double value, const char* unit);
/// A vector component in nine columns: three decimals, or an exponent if the value is too small or large.
std::string component_text(double value);
std::string bytes_text(std::int64_t bytes);

/// Colour of a stage in graph and table, 0xAABBGGRR. `stage_colors` exceeds the number of stages.
inline constexpr std::size_t stage_colors = 20;
std::uint32_t stage_color(std::size_t stage, bool light);
/// Standard term for a stage, such as "narrow phase: contact points and normals". Returns `name` if unknown.
std::string_view stage_term(std::string_view name);

}  // namespace collidoscope
