#include "ui/chart.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/theme.h"

namespace collidoscope {
namespace {

ImVec2 text_size(const std::string& text) { return ImGui::CalcTextSize(text.c_str()); }

/// Maps values to pixels along one axis.
class Scale {
 public:
  Scale(const ChartAxis& axis, double least, double most, float from, float to)
      : axis_(axis), low_(place(least)), high_(place(most)), from_(from), to_(to) {}
  bool shows(double value) const {
    return std::isfinite(value) && (!axis_.logarithmic || value > 0) && place(value) >= low_ - 1e-9 &&
           place(value) <= high_ + 1e-9;
  }
  float pixel(double value) const {
    return from_ + static_cast<float>((place(value) - low_) / (high_ - low_)) * (to_ - from_);
  }
  /// Values outside the axis map to its nearer end.
  float pixel_within(double value) const {
    const double at = axis_.logarithmic && !(value > 0) ? low_ : std::clamp(place(value), low_, high_);
    return from_ + static_cast<float>((at - low_) / (high_ - low_)) * (to_ - from_);
  }
  double value(float pixel) const {
    const double at = low_ + static_cast<double>((pixel - from_) / (to_ - from_)) * (high_ - low_);
    return axis_.logarithmic ? std::pow(10, at) : at;
  }
  double place(double value) const { return axis_.logarithmic ? std::log10(value) : value; }
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  const ChartAxis& axis_;
  double low_, high_;
  float from_, to_;
};

struct Range {
  double least = 1e300, most = -1e300;
  void take(double value, bool positive) {
    if (!std::isfinite(value) || (positive && value <= 0)) return;
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

/// Range of the axis: the requested limits, else the range of the points with a margin.
Range shown(const ChartAxis& axis, Range data) {
  if (data.least > data.most) data = axis.logarithmic ? Range{1, 10} : Range{0, 1};
  if (axis.logarithmic) {
    const double room = std::pow(data.most / data.least, 0.04) * 1.05;
    data = {data.least / room, data.most * room};
  } else {
    if (data.least > 0 && data.least < 0.5 * data.most) data.least = 0;
    const double room =
        std::max(0.05 * (data.most - data.least), 1e-9 * std::max(std::abs(data.most), 1e-12));
    data = {data.least == 0 ? 0 : data.least - room, data.most + room};
  }
  if (std::isfinite(axis.least)) data.least = axis.least;
  if (std::isfinite(axis.most)) data.most = axis.most;
  return data;
}

struct Tick {
  double value;
  bool labelled;
};

std::vector<Tick> ticks_of(const ChartAxis& axis, const Range& range) {
  std::vector<Tick> ticks;
  if (axis.logarithmic) {
    const double decades = std::log10(range.most / range.least);
    const int every = std::max(1, static_cast<int>(std::ceil(decades / 9)));
    for (int e = static_cast<int>(std::floor(std::log10(range.least))); std::pow(10, e) <= range.most; ++e)
      for (int digit = 1; digit < 10; ++digit) {
        const double value = digit * std::pow(10, e);
        if (value < range.least || value > range.most) continue;
        const bool named = digit == 1 ? e % every == 0 : decades < 2.5 && (digit == 2 || digit == 5);
        ticks.push_back({value, named});
      }
    return ticks;
  }
  const double span = range.most - range.least, unit = std::pow(10, std::floor(std::log10(span / 4)));
  double step = unit;
  for (const double factor : {2.0, 5.0, 10.0})
    if (span / step > 7) step = factor * unit;
  for (double k = std::ceil(range.least / step); k * step <= range.most + 1e-9 * span; ++k)
    ticks.push_back({k * step, true});
  return ticks;
}

void draw_mark(ImDrawList* list, ImVec2 at, float r, std::size_t shape, ImU32 color) {
  switch (shape) {
    case 0:
      return list->AddCircleFilled(at, r, color, 20);
    case 1:
      return list->AddRectFilled({at.x - 0.9f * r, at.y - 0.9f * r}, {at.x + 0.9f * r, at.y + 0.9f * r},
                                 color);
    case 2:
      return list->AddQuadFilled({at.x, at.y - 1.25f * r}, {at.x + 1.25f * r, at.y}, {at.x, at.y + 1.25f * r},
                                 {at.x - 1.25f * r, at.y}, color);
    default:
      return list->AddTriangleFilled({at.x, at.y - 1.2f * r}, {at.x + 1.1f * r, at.y + 0.8f * r},
                                     {at.x - 1.1f * r, at.y + 0.8f * r}, color);
  }
}

void draw_line(ImDrawList* list, ImVec2 a, ImVec2 b, ImU32 color, float thick, bool dashed, float dash) {
  if (!dashed) return list->AddLine(a, b, color, thick);
  const float length = std::hypot(b.x - a.x, b.y - a.y);
  for (float at = 0; at < length; at += 2 * dash) {
    const float end = std::min(at + dash, length);
    const auto along = [&](float d) {
      return ImVec2(a.x + (b.x - a.x) * d / length, a.y + (b.y - a.y) * d / length);
    };
    list->AddLine(along(at), along(end), color, thick);
  }
}

/// Positions of the names in a column: each as near to the end of its series as possible, without overlap.
std::vector<float> spread_out(std::vector<float> wanted, float height, float top, float bottom) {
  std::vector<std::size_t> order(wanted.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return wanted[k]; });
  for (int pass = 0; pass < 2; ++pass) {
    float free_from = top;
    for (const std::size_t k : order) {
      wanted[k] = std::max(wanted[k], free_from);
      free_from = wanted[k] + height;
    }
    float free_to = bottom;
    for (std::size_t i = order.size(); i-- > 0;) {
      wanted[order[i]] = std::min(wanted[order[i]], free_to - height);
      free_to = wanted[order[i]];
    }
  }
  return wanted;
}

}  // namespace

std::string short_number(double value) {
  for (const auto& [unit, name] : {std::pair{1e9, "G"}, {1e6, "M"}, {1e3, "k"}})
    if (std::abs(value) >= unit) return fmt::format("{:.4g}{}", value / unit, name);
  return fmt::format("{:.3g}", value);
}

ChartHit draw_chart(const char* id, float width, float height, const Chart& chart) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton(id, {std::max(width, 1.0f), std::max(height, 1.0f)});
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const float line = ImGui::GetTextLineHeight(), pad = 0.5f * line, thick = std::max(1.0f, line / 9);
  const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text), faint = ImGui::GetColorU32(ImGuiCol_TextDisabled),
              grid = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.30f),
              fine = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.11f);

  Range x_data, y_data;
  for (const ChartSeries& series : chart.series)
    for (const ChartPoint& p : series.points) {
      x_data.take(p.x, chart.x.logarithmic);
      y_data.take(p.y, chart.y.logarithmic);
      if (!chart.fits_error_bars) continue;
      for (const double x : {p.x_low, p.x_high}) x_data.take(x, chart.x.logarithmic);
      for (const double y : {p.y_low, p.y_high}) y_data.take(y, chart.y.logarithmic);
    }
  y_data.take(chart.level, chart.y.logarithmic);
  const Range xs = shown(chart.x, x_data), ys = shown(chart.y, y_data);
  const std::vector<Tick> x_ticks = ticks_of(chart.x, xs), y_ticks = ticks_of(chart.y, ys);

  float names = 0, numbers = 0;
  for (const ChartSeries& series : chart.series)
    if (chart.names) names = std::max(names, text_size(series.name).x);
  for (const Tick& tick : y_ticks)
    if (tick.labelled) numbers = std::max(numbers, text_size(chart.y.number(tick.value)).x);
  const float lead = chart.series.empty() || !chart.names ? 0 : 2.2f * line;
  const float left = at.x + pad + numbers + 0.5f * line, right = at.x + width - pad - names - lead;
  const float top = at.y + (chart.title.empty() ? 0 : 1.3f * line) + 1.5f * line;
  const float bottom = at.y + height - (chart.note.empty() ? 0 : 1.2f * line) - 2.9f * line;
  const Scale x(chart.x, xs.least, xs.most, left, right), y(chart.y, ys.least, ys.most, bottom, top);

  list->PushClipRect(at, {at.x + width, at.y + height}, true);
  if (!chart.title.empty()) list->AddText({at.x + pad, at.y + 0.1f * line}, ink, chart.title.c_str());
  list->AddText({at.x + pad, top - 1.35f * line}, faint, chart.y.label.c_str());
  const ImVec2 label = text_size(chart.x.label);
  list->AddText({0.5f * (left + right - label.x), bottom + 1.45f * line}, faint, chart.x.label.c_str());
  if (!chart.note.empty())
    list->AddText({at.x + pad, at.y + height - 1.2f * line}, faint, chart.note.c_str());
  float written_to = -1e9f;
  for (const Tick& tick : x_ticks) {
    const float px = x.pixel(tick.value);
    list->AddLine({px, top}, {px, bottom}, tick.labelled ? grid : fine);
    const std::string text = chart.x.number(tick.value);
    const float from = px - 0.5f * text_size(text).x;
    if (!tick.labelled || from < written_to + 0.5f * line) continue;
    list->AddText({from, bottom + 0.25f * line}, faint, text.c_str());
    written_to = from + text_size(text).x;
  }
  written_to = 1e9f;
  for (const Tick& tick : y_ticks) {
    const float py = y.pixel(tick.value);
    list->AddLine({left, py}, {right, py}, tick.labelled ? grid : fine);
    if (!tick.labelled || py + 1.05f * line > written_to) continue;
    const std::string text = chart.y.number(tick.value);
    list->AddText({left - 0.5f * line - text_size(text).x, py - 0.5f * line}, faint, text.c_str());
    written_to = py;
  }
  list->AddRect({left, top}, {right, bottom}, grid);

  ChartHit hit;
  hit.left = left;
  hit.top = top;
  hit.right = right;
  hit.bottom = bottom;
  const auto write_at = [&](float px, float py, const std::string& text) {  // clamped into the plot area
    py = std::clamp(py, top, std::max(bottom - line, top));
    list->AddText({px, py}, faint, text.c_str());
    return py;
  };
  if (std::isfinite(chart.floor) && chart.floor > ys.least) {
    const float at_floor = y.pixel(std::min(chart.floor, ys.most));
    list->AddRectFilled({left, at_floor}, {right, bottom}, ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.16f));
    write_at(left + 0.3f * line, std::max(at_floor + 0.1f * line, bottom - 1.1f * line), chart.floor_name);
  }
  if (y.shows(chart.level)) {
    hit.level_at = y.pixel(chart.level);
    list->AddLine({left, hit.level_at}, {right, hit.level_at}, ImGui::GetColorU32(ImGuiCol_CheckMark),
                  1.5f * thick);
    list->AddTriangleFilled({right - 0.7f * line, hit.level_at}, {right, hit.level_at + 0.4f * line},
                            {right, hit.level_at - 0.4f * line}, ImGui::GetColorU32(ImGuiCol_CheckMark));
    const float from = right - text_size(chart.level_name).x - 0.9f * line;
    const bool above = hit.level_at - 1.15f * line >= top;  // otherwise the line would cross the text
    hit.level_name_at = write_at(from, hit.level_at + (above ? -1.15f : 0.15f) * line, chart.level_name);
  }
  float nearest = 1.2f * line;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  std::vector<std::size_t> named;  // indices of series
  std::vector<float> wanted;
  std::vector<ImVec2> ends;
  const float r = 0.26f * line;
  const auto mark_of = [&](std::size_t s) {
    return chart.series[s].mark < 0
               ? (s + s / 12) % 4  // colours repeat after twelve series, with another mark
               : static_cast<std::size_t>(chart.series[s].mark);
  };
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const ChartSeries& series = chart.series[s];
    ImVec2 last{right, 0.5f * (top + bottom)};
    bool joined = false;
    for (std::size_t k = 0; k < series.points.size(); ++k) {
      const ChartPoint& p = series.points[k];
      if (!x.shows(p.x) || !y.shows(p.y)) {
        joined = false;
        continue;
      }
      const ImVec2 here{x.pixel(p.x), y.pixel(p.y)};
      const auto clamped = [](const Scale& scale, double value, double otherwise) {
        return std::isnan(value) ? scale.pixel(otherwise) : scale.pixel_within(value);
      };
      if (std::isfinite(p.y_low) || std::isfinite(p.y_high))
        list->AddLine({here.x, clamped(y, p.y_low, p.y)}, {here.x, clamped(y, p.y_high, p.y)}, series.color,
                      thick);
      if (std::isfinite(p.x_low) || std::isfinite(p.x_high))
        list->AddLine({clamped(x, p.x_low, p.x), here.y}, {clamped(x, p.x_high, p.x), here.y}, series.color,
                      thick);
      if (series.line && joined)
        draw_line(list, last, here, series.color, (series.broad ? 4.5f : 1.3f) * thick, series.dashed,
                  0.4f * line);
      if (series.marks) draw_mark(list, here, r, mark_of(s), series.color);
      if (p.ring != 0) list->AddCircle(here, 1.8f * r, p.ring, 24, 1.5f * thick);
      hit.places.push_back({static_cast<int>(s), static_cast<int>(k), here.x, here.y});
      const float distance = std::hypot(mouse.x - here.x, mouse.y - here.y);
      if (hovered && distance < nearest) {
        nearest = distance;
        hit.series = static_cast<int>(s);
        hit.point = static_cast<int>(k);
      }
      last = here;
      joined = true;
    }
    if (series.name.empty() || !chart.names) continue;
    named.push_back(s);
    ends.push_back(last);
    wanted.push_back(last.y - 0.5f * line);
  }
  const std::vector<float> places = spread_out(wanted, 1.08f * line, top - 0.5f * line, bottom + 0.5f * line);
  for (std::size_t k = 0; k < named.size(); ++k) {
    const std::size_t s = named[k];
    const ChartSeries& series = chart.series[s];
    const float middle = places[k] + 0.5f * line;
    const ImU32 thin = (series.color & 0x00ffffffu) | 0x70000000u;
    if (series.line) {
      list->AddLine({ends[k].x + r, ends[k].y}, {right + 0.3f * line, ends[k].y}, thin);
      list->AddLine({right + 0.3f * line, ends[k].y}, {right + 1.1f * line, middle}, thin);
    }
    if (series.marks)
      draw_mark(list, {right + 1.5f * line, middle}, r, mark_of(s), series.color);
    else
      draw_line(list, {right + 1.1f * line, middle}, {right + 1.9f * line, middle}, series.color,
                1.3f * thick, series.dashed, 0.3f * line);
    list->AddText({right + lead, places[k]}, ink, series.name.c_str());
  }
  // The grip at the right end always belongs to the line. Elsewhere the nearer of line and point is selected.
  const float off_line = std::abs(mouse.y - hit.level_at);
  const bool at_grip = off_line < 0.6f * line && std::abs(mouse.x - right) < 0.8f * line;
  hit.level = hovered && hit.level_at > 0 && mouse.x >= left &&
              (at_grip || (off_line < 0.4f * line && off_line < nearest));
  if (hit.level) hit.series = hit.point = -1;
  if (hit.point >= 0) {
    const ChartSeries& series = chart.series[static_cast<std::size_t>(hit.series)];
    const ChartPoint& p = series.points[static_cast<std::size_t>(hit.point)];
    list->AddCircle({x.pixel(p.x), y.pixel(p.y)}, 2.1f * r, ink, 24, thick);
    if (chart.has_tooltip) {
      ImGui::BeginTooltip();
      ImGui::TextUnformatted(series.name.c_str());
      ImGui::TextUnformatted(fmt::format("{}: {}", chart.x.label, chart.x.number(p.x)).c_str());
      ImGui::TextUnformatted(fmt::format("{}: {}", chart.y.label, chart.y.number(p.y)).c_str());
      ImGui::EndTooltip();
    }
  }
  hit.x = x.value(mouse.x);
  hit.y = y.value(mouse.y);
  list->PopClipRect();
  return hit;
}

void draw_chart_page(float width, float height, float font_size, const Chart& chart) {
  apply_theme(Theme::light, font_size);
  ImGuiStyle& style = ImGui::GetStyle();
  style.Colors[ImGuiCol_WindowBg] = {1, 1, 1, 1};
  style.WindowBorderSize = 0;
  style.WindowRounding = 0;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::Begin("chart", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  draw_chart("chart", room.x, room.y, chart);
  ImGui::End();
}

}  // namespace collidoscope
