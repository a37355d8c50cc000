#include "ui/plot.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace collidoscope {
namespace {

struct Area {
  ImVec2 at;
  float width, height;
  bool hovered, pressed;
  ImDrawList* list;
};

Area begin(const char* id, float width, float height) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton(id, {std::max(width, 1.0f), std::max(height, 1.0f)});
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.55f), 3);
  return {at, width, height, ImGui::IsItemHovered(), ImGui::IsItemActive(), list};
}

// Rounds up to a value with one significant digit, or 1.5 times a power of ten.
double round_axis(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double unit = std::pow(10, std::floor(std::log10(value)));
  for (double factor : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value <= factor * unit * (1 + 1e-9)) return factor * unit;
  return 10 * unit;
}

void tooltip_line(const std::string& name, ImU32 color, const std::string& value) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float size = ImGui::GetFontSize();
  ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 0.25f * size},
                                            {at.x + 0.55f * size, at.y + 0.8f * size}, color, 2);
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + size);
  ImGui::TextUnformatted((name + "  " + value).c_str());
}

}  // namespace

std::optional<std::int64_t> plot_lines(const char* id, float width, float height, const PlotFrame& frame,
                                       const std::vector<PlotLine>& lines) {
  const Area area = begin(id, width, height);
  const float line_height = ImGui::GetTextLineHeight(), pad = 0.35f * line_height;
  double least = frame.from_zero ? 0 : 1e300, most = frame.from_zero ? 0 : -1e300;
  std::size_t count = 0;
  for (const PlotLine& line : lines) {
    count = std::max(count, line.values.size());
    for (float v : line.values)
      if (std::isfinite(v)) {
        least = std::min(least, static_cast<double>(v));
        most = std::max(most, static_cast<double>(v));
      }
  }
  const bool any = least <= most;
  if (!any) least = 0, most = 1;
  if (frame.from_zero) {
    most = most > 0 || least == 0 ? round_axis(most) : 0;
    least = least < 0 ? -round_axis(-least) : 0;
  } else {
    const double room = std::max(0.08 * (most - least), 1e-6 * std::max(std::abs(most), 1e-12));
    least -= room;
    most += room;
  }
  // One line of text: title, names of the lines, end of the axis. The names are in the tooltip only if they
  // do not fit.
  const std::string axis = !any             ? ""
                           : least == -most ? "±" + frame.number(most)
                           : least < 0      ? frame.number(least) + " to " + frame.number(most)
                                            : frame.number(most);
  const auto width_of = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
  float keys = 0;
  for (const PlotLine& line : lines) keys += width_of(line.name) + 0.7f * line_height;
  float key = area.at.x + pad + width_of(frame.title) + 0.9f * line_height;
  const bool keys_fit = lines.size() > 1 && key + keys + width_of(axis) < area.at.x + width - pad;
  const float top = area.at.y + 1.35f * line_height, bottom = area.at.y + height - pad;
  const auto y_of = [&](double v) {
    return bottom - static_cast<float>((v - least) / (most - least)) * (bottom - top);
  };
  const auto x_of = [&](std::size_t i) {
    return area.at.x + pad +
           (width - 2 * pad) * (count > 1 ? static_cast<float>(i) / static_cast<float>(count - 1) : 0.5f);
  };
  area.list->PushClipRect(area.at, {area.at.x + width, area.at.y + height}, true);
  const ImU32 faint = ImGui::GetColorU32(ImGuiCol_TextDisabled),
              grid = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.22f);
  for (const double value : {least, least < 0 && most > 0 ? 0 : (least + most) / 2, most})
    area.list->AddLine({area.at.x + pad, y_of(value)}, {area.at.x + width - pad, y_of(value)}, grid);
  const float text_y = area.at.y + 0.15f * line_height, right = area.at.x + width - pad;
  area.list->AddText({area.at.x + pad, text_y}, ImGui::GetColorU32(ImGuiCol_Text), frame.title.c_str());
  area.list->AddText({right - width_of(axis), text_y}, faint, axis.c_str());
  for (const PlotLine& line : lines) {
    std::vector<ImVec2> run;
    const auto flush = [&] {
      if (run.size() > 1)
        area.list->AddPolyline(run.data(), static_cast<int>(run.size()), line.color, 0,
                               std::max(1.0f, line_height / 10));
      run.clear();
    };
    for (std::size_t i = 0; i < line.values.size(); ++i) {
      if (std::isnan(line.values[i])) continue;
      if (std::isinf(line.values[i])) {
        flush();
        continue;
      }
      run.emplace_back(x_of(i), y_of(static_cast<double>(line.values[i])));
    }
    flush();
    if (keys_fit) area.list->AddText({key, text_y}, line.color, line.name.c_str());
    key += width_of(line.name) + 0.7f * line_height;
  }
  const std::int64_t shown = frame.shown_step - frame.first_step;
  if (shown >= 0 && shown + 1 < static_cast<std::int64_t>(count)) {
    const float x = x_of(static_cast<std::size_t>(shown));
    area.list->AddLine({x, top}, {x, bottom}, ImGui::GetColorU32(ImGuiCol_Text),
                       std::max(1.0f, line_height / 12));
  }
  std::optional<std::int64_t> clicked;
  if (area.hovered && count > 0) {
    const float share = (ImGui::GetIO().MousePos.x - area.at.x - pad) / std::max(width - 2 * pad, 1.0f);
    const auto i = static_cast<std::size_t>(
        std::clamp(std::round(share * static_cast<float>(count - 1)), 0.0f, static_cast<float>(count - 1)));
    area.list->AddLine({x_of(i), top}, {x_of(i), bottom}, faint);
    if (area.pressed) clicked = frame.first_step + static_cast<std::int64_t>(i);
    ImGui::BeginTooltip();
    ImGui::TextUnformatted(fmt::format("state {}", frame.first_step + static_cast<std::int64_t>(i)).c_str());
    for (const PlotLine& line : lines)
      if (i < line.values.size() && std::isfinite(line.values[i]))
        tooltip_line(line.name, line.color, frame.number(static_cast<double>(line.values[i])));
    ImGui::EndTooltip();
  }
  area.list->PopClipRect();
  return clicked;
}

float stacked_axis(std::vector<float> values) {
  // A single slow step (page fault, other process) must not compress the axis.
  float most = 0;
  if (!values.empty()) {
    std::sort(values.begin(), values.end());
    const double place = std::ceil(0.9 * static_cast<double>(values.size() - 1));
    most = std::min(values.back(), 1.5f * values[static_cast<std::size_t>(place)]);
  }
  return static_cast<float>(round_axis(static_cast<double>(most)));
}

StackedUnder plot_stacked(const char* id, float width, float height, const StackedBars& bars) {
  const Area area = begin(id, width, height);
  const float line_height = ImGui::GetTextLineHeight(), pad = 0.35f * line_height;
  const std::size_t count = bars.parts.size();
  std::vector<float> tops;
  for (const auto& parts : bars.parts) {
    float sum = 0;
    for (float part : parts) sum += std::max(part, 0.0f);
    if (!parts.empty()) tops.push_back(sum);
  }
  for (float v : bars.line)
    if (std::isfinite(v)) tops.push_back(v);
  const float axis = stacked_axis(tops);
  const float top = area.at.y + 1.5f * line_height, bottom = area.at.y + height - pad;
  const auto y_of = [&](float v) { return bottom - std::min(v / axis, 1.0f) * (bottom - top); };
  const float bar = (width - 2 * pad) / static_cast<float>(std::max<std::size_t>(count, 1));
  area.list->PushClipRect(area.at, {area.at.x + width, area.at.y + height}, true);
  StackedUnder result;
  std::size_t hovered_bar = count;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (area.hovered && count > 0)
    hovered_bar = static_cast<std::size_t>(
        std::clamp((mouse.x - area.at.x - pad) / bar, 0.0f, static_cast<float>(count - 1)));
  // A step without stage times lies between two steps with stage times. The tooltip shows the step before it.
  if (hovered_bar < count && bars.parts[hovered_bar].empty() && hovered_bar > 0) --hovered_bar;
  for (std::size_t i = 0; i < count; ++i) {
    if (bars.parts[i].empty()) continue;
    const float from = area.at.x + pad + bar * static_cast<float>(i);
    // A bar extends over the following step without stage times.
    const bool wide = i + 1 < count && bars.parts[i + 1].empty();
    const float to = from + bar * (wide ? 2 : 1);
    float sum = 0;
    for (std::size_t k = 0; k < bars.parts[i].size(); ++k) {
      const float part = std::max(bars.parts[i][k], 0.0f);
      if (part == 0) continue;
      const float low = y_of(sum), high = y_of(sum + part);
      sum += part;
      ImU32 color = bars.colors[k];
      if (bars.highlighted >= 0 && static_cast<int>(k) != bars.highlighted)
        color = (color & 0x00ffffffu) | 0x48000000u;
      area.list->AddRectFilled({from, high}, {to, low}, color);
      if (i == hovered_bar && mouse.y <= low && mouse.y > high) result.part = static_cast<int>(k);
    }
  }
  const std::int64_t shown = bars.shown_step - bars.first_step;
  if (shown >= 0 && shown + 1 < static_cast<std::int64_t>(count)) {
    const float x = area.at.x + pad + bar * (static_cast<float>(shown) + 0.5f);
    area.list->AddLine({x, top}, {x, bottom}, ImGui::GetColorU32(ImGuiCol_Text),
                       std::max(1.0f, line_height / 12));
  }
  if (area.pressed && hovered_bar < count)
    result.click = bars.first_step + static_cast<std::int64_t>(hovered_bar);
  // An arrowhead at the axis marks a value beyond it.
  const ImU32 text_color = ImGui::GetColorU32(ImGuiCol_Text);
  const auto mark_cut = [&](float x, float value) {
    if (!(value > axis)) return;
    const float half = std::max(0.22f * line_height, 2.0f);
    area.list->AddTriangleFilled({x - half, top + 2 * half}, {x + half, top + 2 * half}, {x, top},
                                 text_color);
  };
  std::vector<ImVec2> run;
  for (std::size_t i = 0; i < bars.line.size(); ++i)
    if (std::isfinite(bars.line[i]))
      run.emplace_back(area.at.x + pad + bar * (static_cast<float>(i) + 0.5f), y_of(bars.line[i]));
  for (std::size_t i = 0; i < count; ++i) {
    const float line = i < bars.line.size() && std::isfinite(bars.line[i]) ? bars.line[i] : 0;
    float parts = 0;
    for (const float part : bars.parts[i]) parts += std::max(part, 0.0f);
    mark_cut(area.at.x + pad + bar * (static_cast<float>(i) + 0.5f), std::max(line, parts));
  }
  // Clips the mitre of a sharp corner, which would reach into the title.
  area.list->PushClipRect({area.at.x, top - 0.25f * line_height}, {area.at.x + width, area.at.y + height},
                          true);
  if (run.size() > 1)
    area.list->AddPolyline(run.data(), static_cast<int>(run.size()), ImGui::GetColorU32(ImGuiCol_Text), 0,
                           std::max(1.0f, line_height / 11));
  area.list->PopClipRect();
  const ImU32 faint = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  // One line of text: title, the nearest mark above the axis, end of the axis. Texts that do not fit are left
  // out.
  const char* const title = "stage ms (line: step)";
  const std::string axis_text = tops.empty() ? "" : fmt::format("{:g} ms", axis);
  const auto width_of = [](const char* text) { return ImGui::CalcTextSize(text).x; };
  const float title_end = area.at.x + pad + width_of(title) + 0.5f * line_height,
              axis_begin = area.at.x + width - pad - width_of(axis_text.c_str());
  bool beyond = false;
  for (const StackedBars::Mark& mark : bars.marks) {
    if (mark.value > axis) {
      const std::string text = fmt::format("↑ {}: {:.1f} ms", mark.label, mark.value);
      const float text_width = width_of(text.c_str());
      const float x = std::max(area.at.x + 0.5f * (width - text_width) + 3 * line_height, title_end);
      if (!beyond && !tops.empty() && x >= title_end && x + text_width + 0.5f * line_height <= axis_begin)
        area.list->AddText({x, area.at.y + 0.15f * line_height}, faint, text.c_str());
      beyond = true;
      continue;
    }
    const float y = y_of(mark.value);
    area.list->AddLine({area.at.x + pad, y}, {area.at.x + width - pad, y},
                       ImGui::GetColorU32(ImGuiCol_Text, 0.5f));
    const ImVec2 size = ImGui::CalcTextSize(mark.label.c_str());
    const ImVec2 from{area.at.x + width - pad - size.x, y - line_height};
    area.list->AddRectFilled({from.x - 0.2f * line_height, from.y}, {from.x + size.x, from.y + size.y},
                             ImGui::GetColorU32(ImGuiCol_WindowBg, 0.85f), 2);
    area.list->AddText(from, ImGui::GetColorU32(ImGuiCol_Text), mark.label.c_str());
  }
  area.list->AddText({area.at.x + pad, area.at.y + 0.15f * line_height}, ImGui::GetColorU32(ImGuiCol_Text),
                     title);
  if (count == 0) {
    const ImVec2 size = ImGui::CalcTextSize(bars.note.c_str());
    area.list->AddText({area.at.x + 0.5f * (width - size.x), area.at.y + 0.5f * (height - size.y)}, faint,
                       bars.note.c_str());
  }
  if (axis_begin >= title_end)
    area.list->AddText({axis_begin, area.at.y + 0.15f * line_height}, faint, axis_text.c_str());
  area.list->PopClipRect();
  if (hovered_bar < count && !bars.parts[hovered_bar].empty()) {
    ImGui::BeginTooltip();
    ImGui::TextUnformatted(
        fmt::format("state {}", bars.first_step + static_cast<std::int64_t>(hovered_bar)).c_str());
    for (std::size_t k = bars.parts[hovered_bar].size(); k-- > 0;)
      if (bars.parts[hovered_bar][k] >= 0)
        tooltip_line(bars.names[k], bars.colors[k], fmt::format("{:.3f} ms", bars.parts[hovered_bar][k]));
    ImGui::EndTooltip();
  }
  return result;
}

}  // namespace collidoscope
