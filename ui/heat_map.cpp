#include "ui/heat_map.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/heat_map_cells.h"
#include "ui/theme.h"

namespace collidoscope {
namespace {

/// Place of a value among the columns or rows: 0 is the centre of the first, 1 of the second.
double heat_place(const std::vector<double>& values, double value) {
  const std::size_t count = values.size();
  if (count == 1) return value < values[0] ? -0.5 : value > values[0] ? 0.5 : 0;
  std::size_t upper = 1;
  while (upper + 1 < count && value > values[upper]) ++upper;
  const double low = std::log2(values[upper - 1]), high = std::log2(values[upper]);
  return static_cast<double>(upper - 1) + (std::log2(value) - low) / (high - low);
}

bool is_between(const HeatAxis& axis, double value) {
  return std::ranges::find(axis.values, value) == axis.values.end();
}

/// A small cell lies on the border between two columns or rows, or at the outer border.
double heat_border(const HeatAxis& axis, double value) {
  const double last = static_cast<double>(axis.values.size()) - 1;
  return std::clamp(std::floor(heat_place(axis.values, value)) + 0.5, -0.5, last + 0.5);
}

/// Round values from `low` to `high`, at most eight, and the decimals that they need.
struct BarTicks {
  std::vector<double> values;
  int decimals = 0;
};
BarTicks bar_ticks(double low, double high) {
  BarTicks ticks;
  const double span = high - low;
  double step = std::pow(10, std::floor(std::log10(span / 8)));
  for (const double factor : {2.0, 2.5, 2.0})
    if (span / step > 8) step *= factor;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); ++k)
    ticks.values.push_back(k * step);
  while (ticks.decimals < 6 && std::abs(step * std::pow(10, ticks.decimals) -
                                        std::round(step * std::pow(10, ticks.decimals))) > 1e-6)
    ++ticks.decimals;
  return ticks;
}

class HeatDrawing {
 public:
  HeatDrawing(const HeatMap& map, ImVec2 at, float width, float height)
      : map_(map),
        list_(ImGui::GetWindowDrawList()),
        line_(ImGui::GetTextLineHeight()),
        text_{ImGui::GetFont(), ImGui::GetFontSize()},
        whole_{at.x, at.y, at.x + width, at.y + height} {}

  void draw() {
    if (whole_.width() <= 0) return;
    const float top = draw_heading();
    const float bottom = draw_footing();
    lay_out(top, bottom);
    if (std::min(plot_.width(), plot_.height()) < line_) return;  // no room
    draw_axes();
    draw_cells();
    draw_mark();
    draw_bar();
  }

 private:
  ImU32 ink() const { return ImGui::GetColorU32(ImGuiCol_Text); }
  ImU32 faint() const { return ImGui::GetColorU32(ImGuiCol_TextDisabled); }

  /// Returns its lower end.
  float draw_heading() {
    float y = whole_.top;
    const auto draw_line_of_text = [&](HeatText text, ImU32 color, const std::string& words) {
      if (words.empty()) return;
      if (const float wide = text.extent(words).x; wide > whole_.width()) text.size *= whole_.width() / wide;
      text.draw(list_, {whole_.left, y}, 0, 0, color, words);
      y += 1.3f * text.size;
    };
    const ImFontAtlas* const fonts = ImGui::GetIO().Fonts;
    ImFont* const large = fonts->Fonts[fonts->Fonts.Size - 1];
    draw_line_of_text({large, large->FontSize}, ink(), map_.title);
    draw_line_of_text(text_, faint(), map_.subtitle);
    draw_line_of_text(text_, ImGui::GetColorU32(ImGuiCol_CheckMark), map_.verdict);
    return y;
  }

  struct KeyEntry {
    HeatCell cell;
    const std::string* name;
    bool is_mark = false, is_small = false;
  };

  std::vector<KeyEntry> key() const {
    std::vector<KeyEntry> entries;
    const auto has = [&](const auto& test) { return std::ranges::any_of(map_.cells, test); };
    for (const auto& [frame, name] : {std::pair{HeatCell::Frame::thick, &map_.thick_name},
                                      std::pair{HeatCell::Frame::thin, &map_.thin_name}})
      if (!name->empty() && has([wanted = frame](const HeatCell& cell) { return cell.frame == wanted; }))
        entries.push_back({{0, 0, HeatCell::Kind::value, map_.low, frame}, name});
    if (map_.mark && !map_.mark_name.empty()) entries.push_back({{}, &map_.mark_name, true});
    if (!map_.small_name.empty() && has([&](const HeatCell& cell) { return is_small(cell); }))
      entries.push_back({{0, 0, HeatCell::Kind::value, map_.low}, &map_.small_name, false, true});
    for (const auto& [kind, name] : {std::pair{HeatCell::Kind::hatched, &map_.hatched_name},
                                     std::pair{HeatCell::Kind::crossed, &map_.crossed_name},
                                     std::pair{HeatCell::Kind::dashed, &map_.dashed_name},
                                     std::pair{HeatCell::Kind::empty, &map_.empty_name}})
      if (!name->empty() && has([wanted = kind](const HeatCell& cell) { return cell.kind == wanted; }))
        entries.push_back({{0, 0, kind}, name});
    return entries;
  }

  /// Note and key. Returns the upper end.
  float draw_footing() {
    float y = whole_.bottom;
    if (!map_.note.empty()) {
      y -= 1.1f * line_;
      HeatText text = text_;
      if (const float wide = text.extent(map_.note).x; wide > whole_.width())
        text.size *= whole_.width() / wide;
      text.draw(list_, {whole_.left, y}, 0, 0, faint(), map_.note);
      y -= 0.4f * line_;
    }
    const std::vector<KeyEntry> entries = key();
    const float swatch = 1.1f * line_, gap = 1.4f * line_;
    std::vector<ImVec2> places;  // from the left end and the first row
    float x = 0, row = 0;
    for (const KeyEntry& entry : entries) {
      const float wide = 1.5f * swatch + text_.extent(*entry.name).x;
      if (x > 0 && x + wide > whole_.width()) x = 0, row += 1.5f * line_;
      places.emplace_back(x, row);
      x += wide + gap;
    }
    if (entries.empty()) return y;
    y -= row + 1.3f * line_;
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const float left = whole_.left + places[k].x, up = y + places[k].y;
      const HeatRect box{left, up, left + swatch, up + swatch};
      if (entries[k].is_mark)
        draw_ring(list_, line_, box.center());
      else
        draw_cell(list_, line_, map_, entries[k].is_small ? box.inset(0.2f * swatch) : box, entries[k].cell,
                  nullptr);
      text_.draw(list_, {left + 1.4f * swatch, box.center().y}, 0, 0.5f, ink(), *entries[k].name);
    }
    return y - 0.4f * line_;
  }

  void lay_out(float top, float bottom) {
    float numbers = 0;
    for (const double value : map_.y.values) numbers = std::max(numbers, text_.extent(axis_number(value)).x);
    const float bar = bar_left_width() + 1.2f * line_ + bar_right_width();
    // Small cells at an outer border need room.
    bool over_left = false, over_right = false, over_top = false, over_bottom = false;
    for (const HeatCell& cell : map_.cells) {
      over_left |= cell.x < map_.x.values.front();
      over_right |= cell.x > map_.x.values.back();
      over_bottom |= cell.y < map_.y.values.front();
      over_top |= cell.y > map_.y.values.back();
    }
    const auto room = [](bool before, bool after) { return 0.25f * static_cast<float>(before + after); };
    plot_ = {whole_.left + numbers + 0.6f * line_, top + 1.8f * line_, whole_.right - bar - 1.6f * line_,
             bottom - 2.9f * line_};
    column_ = plot_.width() / (static_cast<float>(map_.x.values.size()) + room(over_left, over_right));
    row_ = plot_.height() / (static_cast<float>(map_.y.values.size()) + room(over_bottom, over_top));
    first_ = {plot_.left + (over_left ? 0.75f : 0.5f) * column_,
              plot_.bottom - (over_bottom ? 0.75f : 0.5f) * row_};
    const float widest = widest_number();
    number_ = text_;
    number_.size *= std::min({1.0f, 0.62f * column_ / widest, 0.6f * row_ / line_});
    small_number_ = text_;
    small_number_.size *= std::min({0.82f, 0.40f * column_ / widest, 0.36f * row_ / line_});
  }

  float widest_number() const {
    float widest = 1;
    for (const HeatCell& cell : map_.cells)
      if (cell.kind == HeatCell::Kind::value)
        widest = std::max(widest, text_.extent(map_.number(cell.value)).x);
    return widest;
  }

  static std::string axis_number(double value) { return fmt::format("{:g}", value); }
  bool is_small(const HeatCell& cell) const {
    return is_between(map_.x, cell.x) || is_between(map_.y, cell.y);
  }

  ImVec2 pixel(double column, double row) const {
    return {first_.x + static_cast<float>(column) * column_, first_.y - static_cast<float>(row) * row_};
  }

  HeatRect rect_of(const HeatCell& cell) const {
    const bool small = is_small(cell);
    const auto place = [](const HeatAxis& axis, double value) {
      return is_between(axis, value) ? heat_border(axis, value) : heat_place(axis.values, value);
    };
    const ImVec2 at = pixel(place(map_.x, cell.x), place(map_.y, cell.y));
    const float wide = small ? 0.23f * column_ : 0.5f * column_ - 1;
    const float high = small ? std::min(0.23f * row_, 0.9f * line_) : 0.5f * row_ - 1;
    return {std::round(at.x - wide), std::round(at.y - high), std::round(at.x + wide),
            std::round(at.y + high)};
  }

  void draw_axes() {
    text_.draw(list_, {plot_.left, plot_.top - 0.5f * line_}, 0, 1, faint(), map_.y.label);
    text_.draw(list_, {plot_.center().x, plot_.bottom + 1.55f * line_}, 0.5f, 0, faint(), map_.x.label);
    for (std::size_t k = 0; k < map_.x.values.size(); ++k)
      text_.draw(list_, {pixel(static_cast<double>(k), 0).x, plot_.bottom + 0.3f * line_}, 0.5f, 0, ink(),
                 axis_number(map_.x.values[k]));
    for (std::size_t k = 0; k < map_.y.values.size(); ++k)
      text_.draw(list_, {plot_.left - 0.5f * line_, pixel(0, static_cast<double>(k)).y}, 1, 0.5f, ink(),
                 axis_number(map_.y.values[k]));
    // Values between the columns and rows, in smaller text with a tick.
    const HeatText small{text_.font, 0.75f * text_.size};
    for (const HeatCell& cell : map_.cells) {
      const ImVec2 at = rect_of(cell).center();
      if (is_between(map_.x, cell.x)) {
        list_->AddLine({at.x, plot_.bottom}, {at.x, plot_.bottom + 0.35f * line_}, faint(), 1.5f);
        small.draw(list_, {at.x, plot_.bottom + 0.4f * line_}, 0.5f, 0, faint(), axis_number(cell.x));
      }
      if (is_between(map_.y, cell.y)) {
        list_->AddLine({plot_.left - 0.35f * line_, at.y}, {plot_.left, at.y}, faint(), 1.5f);
        small.draw(list_, {plot_.left - 0.5f * line_, at.y}, 1, 0.5f, faint(), axis_number(cell.y));
      }
    }
  }

  void draw_cells() {
    for (const bool small : {false, true}) {
      for (const HeatCell& cell : map_.cells) {
        if (is_small(cell) != small) continue;
        const HeatRect box = rect_of(cell);
        if (small) fill_gap(list_, box.inset(-2.5f));
        draw_cell(list_, line_, map_, box, cell, small ? &small_number_ : &number_);
      }
    }
  }

  void draw_mark() {
    if (!map_.mark) return;
    const double column = heat_place(map_.x.values, map_.mark->x),
                 row = heat_place(map_.y.values, map_.mark->y);
    ImVec2 at = pixel(column, row);
    // Beside the number of a cell, not on it.
    const auto off = [](double place) { return std::abs(place - std::round(place)); };
    if (off(column) < 0.35 && off(row) < 0.35) {
      const ImVec2 center = pixel(std::round(column), std::round(row));
      at = {center.x - 0.5f * column_ + 0.7f * line_, center.y + 0.5f * row_ - 0.7f * line_};
    }
    const HeatRect room = plot_.inset(0.5f * line_);
    draw_ring(
        list_, line_,
        {std::min(std::max(at.x, room.left), room.right), std::min(std::max(at.y, room.top), room.bottom)});
  }

  std::string level_text() const { return map_.level_name + " " + map_.number(*map_.level); }
  /// Three significant digits.
  static std::string second_text(double value) { return fmt::format("{:.3g}", value); }
  float bar_left_width() const {
    float wide = text_.extent(map_.number(map_.high)).x;
    if (map_.level) wide = std::max(wide, text_.extent(level_text()).x);
    return wide + 0.5f * line_;  // the label may be above the map
  }
  float bar_right_width() const {
    return std::max(text_.extent("0.000").x, text_.extent(map_.second_label).x) + 0.5f * line_;
  }

  void draw_bar() {
    const float right = whole_.right - bar_right_width(), left = right - 1.2f * line_;
    const bool above = std::ranges::any_of(map_.cells, [&](const HeatCell& cell) {
      return cell.kind == HeatCell::Kind::value && cell.value > map_.high * (1 + 1e-9);
    });
    const float tip = above ? 0.9f * line_ : 0, top = plot_.top + tip, bottom = plot_.bottom;
    const auto pixel_of = [&](double value) {
      return bottom - static_cast<float>(share_of_bar(map_, value)) * (bottom - top);
    };
    const std::size_t count = map_.colors.size();
    const float step = (bottom - top) / static_cast<float>(count);
    for (std::size_t k = 0; k < count; ++k) {
      const float low = bottom - step * static_cast<float>(k);
      list_->AddRectFilled({left, low - step - 0.5f}, {right, low}, map_.colors[k]);
    }
    if (above)
      list_->AddTriangleFilled({left, top}, {right, top}, {0.5f * (left + right), plot_.top},
                               map_.colors.back());
    const float label_at = plot_.top - 0.5f * line_;
    text_.draw(list_, {left - 0.4f * line_, label_at}, 1, 1, faint(), map_.bar_label);
    const bool has_second = std::isfinite(map_.second_unit);
    if (has_second) text_.draw(list_, {right + 0.4f * line_, label_at}, 0, 1, faint(), map_.second_label);
    const float level_at = map_.level ? pixel_of(*map_.level) : -1e9f;
    const auto draw_ticks = [&](double unit, float x, float outwards) {
      const BarTicks ticks = bar_ticks(map_.low * unit, map_.high * unit);
      for (const double tick : ticks.values) {
        const float y = pixel_of(tick / unit);
        if (std::abs(y - level_at) < 1.1f * line_) continue;
        list_->AddLine({x, y}, {x + outwards * 0.25f * line_, y}, faint(), 1.5f);
        text_.draw(list_, {x + outwards * 0.4f * line_, y}, outwards < 0 ? 1.0f : 0.0f, 0.5f, faint(),
                   fmt::format("{:.{}f}", tick, ticks.decimals));
      }
    };
    draw_ticks(1, left, -1);
    if (has_second) draw_ticks(map_.second_unit, right, 1);
    if (!map_.level) return;
    list_->AddLine({left - 0.3f * line_, level_at}, {right + 0.3f * line_, level_at}, ink(), 2.5f);
    text_.draw(list_, {left - 0.5f * line_, level_at}, 1, 0.5f, ink(), level_text());
    if (has_second)
      text_.draw(list_, {right + 0.5f * line_, level_at}, 0, 0.5f, ink(),
                 second_text(*map_.level * map_.second_unit));
  }

  const HeatMap& map_;
  ImDrawList* list_;
  float line_;
  HeatText text_, number_{}, small_number_{};
  HeatRect whole_, plot_;
  float column_ = 1, row_ = 1;  ///< pixels
  ImVec2 first_{0, 0};          ///< centre of the first column and row
};

}  // namespace

void draw_heat_map(float width, float height, const HeatMap& map) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::Dummy({width, height});
  HeatDrawing(map, at, width, height).draw();
}

void draw_heat_map_page(float width, float height, float font_size, const HeatMap& map) {
  apply_theme(Theme::light, font_size);
  ImGuiStyle& style = ImGui::GetStyle();
  style.Colors[ImGuiCol_WindowBg] = {1, 1, 1, 1};
  style.WindowBorderSize = 0;
  style.WindowPadding = {font_size, 0.8f * font_size};
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::Begin("heat map", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  draw_heat_map(room.x, room.y, map);
  ImGui::End();
}

}  // namespace collidoscope
