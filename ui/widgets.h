#pragma once
// What panels are made of: rows with a name, the record of where widgets are, numbers as people read them.
// Free functions, between ImGui::NewFrame() and Render().

#include <cstdint>
#include <string>
#include <string_view>

#include "ui/workspace.h"

namespace collidoscope {

/// Records where the last widget is, if it can be seen and is not grey.
void track(Workspace& workspace, const char* name);
void track(Workspace& workspace, const char* name, const ScreenRect& rect);

/// A foldable panel's title; draw the panel if it says true. End it with end_panel().
bool begin_panel(Workspace& workspace, const char* name, const char* title, bool& open);
void end_panel();

/// Names the row, and leaves the cursor where its value begins, with the rest of the line as its width.
void row_label(const char* label, const char* help = nullptr);
/// A row of text.
void row_text(const char* label, const std::string& value, const char* help = nullptr);
/// Two rows of text side by side: each call is the next half.
class TextPairs {
 public:
  void operator()(const char* label, const std::string& value, const char* help = nullptr);

 private:
  bool second_ = false;
};
/// Text at the right end of a cell of a table.
void number_cell(const std::string& text);
/// A list to choose from, folded to what is chosen; Escape folds it again. Draw the choices if it says true,
/// and end it with ImGui::EndCombo().
bool begin_choice(const char* id, const char* chosen);
/// Explains the last widget where the pointer rests on it.
void explain(const char* text);
/// In the theme's faint colour.
void faint_text(const std::string& text);

/// 1,234,567.
std::string grouped_number(std::int64_t number);
/// 12.3 ms as "12.3", with about three digits.
std::string short_time(double ms);
/// 1.23e+06 J as "1.23 MJ".
std::string with_prefix(double value, const char* unit);
/// A component of a vector in nine columns: three decimals, or an exponent where they would hide the value.
std::string component_text(double value);
std::string bytes_text(std::int64_t bytes);

/// The colour of a stage in graph and table, 0xAABBGGRR: more of them than a step has stages.
inline constexpr std::size_t stage_colors = 20;
std::uint32_t stage_color(std::size_t stage, bool light);
/// The standard term for a stage of this name: "narrow phase: contact points and normals". The name itself if
/// it is not in the table.
std::string_view stage_term(std::string_view name);

}  // namespace collidoscope
