#include "ui/overlay.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/widgets.h"

namespace collidoscope {
namespace {

constexpr ImU32 bright = IM_COL32(242, 244, 248, 255), plain = IM_COL32(205, 210, 218, 255),
                dim = IM_COL32(140, 148, 160, 255), contact_color = IM_COL32(255, 69, 61, 255);

// Thousands separators: 1234567 is "1,234,567".
std::string grouped(std::int64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3 && digits[i - 4] != '-';) digits.insert(i -= 3, ",");
  return digits;
}

std::string shape_number(int value) { return value ? grouped(value) : "auto"; }

// Text with a shadow, legible on any background.
class Writer {
 public:
  explicit Writer(float size) : size_(size), list_(ImGui::GetForegroundDrawList()), font_(ImGui::GetFont()) {}

  float width(const std::string& text, float scale = 1) const {
    return font_->CalcTextSizeA(size_ * scale, 1e9f, 0, text.c_str()).x;
  }
  void at(float x, float y, const std::string& text, ImU32 color = plain, float scale = 1) const {
    const ImVec2 place{std::round(x), std::round(y)};
    cover(place, font_->CalcTextSizeA(size_ * scale, 1e9f, 0, text.c_str()));
    const float off = std::max(1.0f, std::round(size_ * 0.07f));
    list_->AddText(font_, size_ * scale, {place.x + off, place.y + off}, IM_COL32(0, 0, 0, 150),
                   text.c_str());
    list_->AddText(font_, size_ * scale, place, color, text.c_str());
  }
  /// Draws in the largest loaded font.
  void title(float x, float y, const std::string& text, ImU32 color) const {
    ImFont* font = ImGui::GetIO().Fonts->Fonts.back();
    cover({x, y}, font->CalcTextSizeA(font->FontSize, 1e9f, 0, text.c_str()));
    list_->AddText(font, font->FontSize, {std::round(x) + 1, std::round(y) + 1}, IM_COL32(0, 0, 0, 150),
                   text.c_str());
    list_->AddText(font, font->FontSize, {std::round(x), std::round(y)}, color, text.c_str());
  }
  void right(float x, float y, const std::string& text, ImU32 color = plain) const {
    at(x - width(text), y, text, color);
  }
  void bar(const ImVec2& from, const ImVec2& to, ImU32 color) const {
    cover(from, {to.x - from.x, to.y - from.y});
    list_->AddRectFilled(from, to, color);
  }
  /// Starts a dark background plate behind the following text, up to end_plate().
  void begin_plate() {
    list_->ChannelsSplit(2);
    list_->ChannelsSetCurrent(1);
    low_ = {1e9f, 1e9f};
    high_ = {-1e9f, -1e9f};
  }
  void end_plate() {
    list_->ChannelsSetCurrent(0);
    const float room = 0.7f * size_;
    if (low_.x < high_.x)
      list_->AddRectFilled({low_.x - room, low_.y - room}, {high_.x + room, high_.y + room},
                           IM_COL32(20, 22, 26, 135), 0.5f * size_);
    list_->ChannelsMerge();
  }
  ImDrawList* list() const { return list_; }
  float size() const { return size_; }

 private:
  void cover(const ImVec2& from, const ImVec2& size) const {
    low_ = {std::min(low_.x, from.x), std::min(low_.y, from.y)};
    high_ = {std::max(high_.x, from.x + size.x), std::max(high_.y, from.y + size.y)};
  }

  float size_;
  ImDrawList* list_;
  ImFont* font_;
  mutable ImVec2 low_, high_;  // bounds of the text on the plate
};

// Rows below the scene name. Returns the y position of their end.
float draw_run_info(const Writer& write, const OverlayText& text, float x, float y, float end) {
  const float line = write.size() * 1.45f;
  write.title(x, y, text.scene, bright);
  y += write.size() * 2.2f;
  write.at(x, y,
           fmt::format("state {}{}", grouped(text.state),
                       std::isfinite(text.time) ? fmt::format(" · t = {:.2f} s", text.time) : ""),
           plain);
  y += line * 1.25f;
  std::vector<std::pair<std::string, std::string>> rows{{"N", grouped(text.bodies)}};
  if (!text.variant.empty()) rows.emplace_back("variant", text.variant);
  rows.emplace_back("B × T", shape_number(text.shape.blocks) + " × " + shape_number(text.shape.threads));
  rows.emplace_back("pairs", grouped(text.pairs));
  if (!text.pairs_note.empty()) rows.emplace_back("", text.pairs_note);
  rows.emplace_back("touching", grouped(text.touching));
  rows.emplace_back("speculative", grouped(text.speculative));
  rows.emplace_back("on", text.executor);
  const float column = write.width("speculative  ");
  for (const auto& [name, value] : rows) {
    if (y + line > end) return y;
    write.at(x, y, name, dim);
    write.at(x + column, y, value, bright);
    y += line;
  }
  if (y + line <= end && !text.device.empty()) {
    write.at(x, y, text.device, dim, 0.85f);
    y += line;
  }
  return y;
}

void draw_times(const Writer& write, const OverlayText& text, float right, float y, float end) {
  if (text.stages.empty()) return;
  const float line = write.size() * 1.4f;
  float names = write.width("whole step");
  for (const StageTime& stage : text.stages) names = std::max(names, write.width(stage.name));
  const float numbers = write.width("0000.000 ms");
  const float x = right - numbers - names - write.size();
  const auto time = [&](double ms) { return text.timings ? fmt::format("{:.3f} ms", ms) : std::string("–"); };
  for (const StageTime& stage : text.stages) {
    if (y + line > end) return;
    write.at(x, y, stage.name, dim);
    write.right(right, y, time(stage.median_ms), plain);
    y += line;
  }
  if (y + line > end) return;
  write.list()->AddLine({x, y + 1}, {right, y + 1}, IM_COL32(140, 148, 160, 120));
  y += write.size() * 0.3f;
  write.at(x, y, "whole step", dim);
  write.right(right, y, time(text.step_ms), bright);
}

// Returns the x position of its end.
float draw_color_bar(const Writer& write, const Legend& key, float x, float bottom) {
  const float size = write.size(), width = std::max(size * 13, write.width(title_text(key))),
              height = size * 0.6f;
  const float y = bottom - size * 1.3f - height;
  const std::size_t n = key.colors.size();
  write.at(x, y - size * 1.45f, title_text(key), plain);
  for (std::size_t i = 0; i < n; ++i) {
    const float from = x + width * static_cast<float>(i) / static_cast<float>(n);
    const float to = x + width * static_cast<float>(i + 1) / static_cast<float>(n);
    write.list()->AddRectFilled({std::floor(from), y}, {std::floor(to), y + height}, key.colors[i]);
  }
  write.at(x, y + height + size * 0.25f, low_text(key), plain);
  write.right(x + width, y + height + size * 0.25f, high_text(key), plain);
  return x + width;
}

// From the right margin leftwards: grid, contacts, levels.
void draw_keys(const Writer& write, const OverlayText& text, float right, float y, float left) {
  const float size = write.size();
  const auto key = [&](const std::string& name, const std::vector<PackedColor>& colors) {
    const float x = right - write.width(name);
    if (x - size * 1.6f < left) return;
    write.at(x, y, name, plain);
    right = x - size * 0.5f;
    if (colors.empty()) {
      right -= size * 1.0f;
      return;
    }
    const float bar = size * (colors.size() > 1 ? 3.6f : 0.9f), from = right - bar;
    for (std::size_t i = 0; i < colors.size(); ++i)
      write.bar(
          {from + bar * static_cast<float>(i) / static_cast<float>(colors.size()), y + size * 0.52f},
          {from + bar * static_cast<float>(i + 1) / static_cast<float>(colors.size()), y + size * 0.74f},
          colors[i]);
    right = from - size * 0.6f;
  };
  if (text.grid_spacing > 0) key(fmt::format("grid {:g} m", text.grid_spacing), {});
  for (std::size_t i = text.keys.size(); i-- > 0;) key(text.keys[i].name, {text.keys[i].color});
  if (text.contacts_shown && text.max_impulse > 0)
    key("touching contacts, impulse to " + with_prefix(text.max_impulse, "N s"), text.contact_colors);
  else if (text.contacts_shown)
    key("touching contacts", {contact_color});
  for (std::size_t i = text.levels.size(); i-- > 0;)
    key(std::to_string(text.levels[i].level), {text.levels[i].color});
  const std::string boxes = grouped(text.boxes_drawn) + (text.boxes_drawn == 1 ? " box" : " boxes");
  if (!text.levels.empty()) key(boxes + " of level", {});
  if (!text.box_colors.title.empty()) key(boxes, {});
}

}  // namespace

float overlay_font_size(int width, int height) {
  const float fit = std::min(static_cast<float>(width) / 1280.0f, static_cast<float>(height) / 800.0f);
  return std::round(std::clamp(15.0f * fit, 11.0f, 60.0f));
}

void draw_overlay(const OverlayText& text, float width, float height) {
  Writer write(ImGui::GetFontSize());
  const float margin = write.size() * 1.5f;
  const float legend = height - margin - write.size() * 4;
  if (height < write.size() * 8) return;
  write.begin_plate();
  draw_run_info(write, text, margin, margin * 0.9f, legend);
  write.end_plate();
  write.begin_plate();
  draw_times(write, text, width - margin, margin, legend);
  write.end_plate();
  float keys_from = margin;
  for (const Legend* key : {&text.body_colors, &text.box_colors}) {
    if (key->title.empty()) continue;
    write.begin_plate();
    keys_from = draw_color_bar(write, *key, keys_from, height - margin * 0.7f) + write.size() * 2;
    write.end_plate();
  }
  write.begin_plate();
  draw_keys(write, text, width - margin, height - margin * 0.7f - write.size(), keys_from);
  write.end_plate();
}

}  // namespace collidoscope
