#pragma once
// A heat map: a value for pairs (x, y), as coloured cells with numbers, and a colour bar. Drawn with
// ImDrawList between ImGui::NewFrame() and Render(); stateless.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace collidoscope {

struct HeatCell {
  enum class Kind {
    value,    ///< colour and text of its value
    hatched,  ///< impossible
    crossed,  ///< an error
    dashed,   ///< omitted on purpose
    empty,
  };
  enum class Frame { none, thin, thick };
  double x = 0, y = 0;
  Kind kind = Kind::empty;
  double value = 0;
  Frame frame = Frame::none;
};

/// Columns and rows are the values of each axis; they have equal sizes. Cells between two columns or rows are
/// small and lie on the border between both.
struct HeatAxis {
  std::string label;
  std::vector<double> values;  ///< ascending, at least one
};

struct HeatMap {
  std::string title, subtitle, verdict, note;  ///< lines of text; may be empty
  HeatAxis x, y;
  std::vector<HeatCell> cells;
  std::function<std::string(double)> number;  ///< text of a value in its cell

  std::vector<std::uint32_t> colors;  ///< from `low` to `high`, 0xAABBGGRR
  double low = 1, high = 2;           ///< 0 < low < high; values beyond have the colour of the end
  std::string bar_label;              ///< quantity and unit of the values, on the left side of the bar
  std::string second_label;           ///< the same values in another unit, on its right side
  double second_unit = 1;             ///< size of the value 1 in that unit; NaN: no second scale
  std::optional<double> level;        ///< a marked value of the bar
  std::string level_name;

  struct Mark {
    double x = 0, y = 0;
  };
  std::optional<Mark> mark;  ///< a ring

  /// Texts of the key. Entries that do not occur in the map are not drawn.
  std::string thick_name, thin_name, mark_name, small_name, hatched_name, crossed_name, dashed_name,
      empty_name;
};

/// Draws the map at the cursor in an area of `width` x `height` pixels.
void draw_heat_map(float width, float height, const HeatMap& map);

/// Draws the map alone on white, as a whole frame of this size.
void draw_heat_map_page(float width, float height, float font_size, const HeatMap& map);

}  // namespace collidoscope
