#include "ui/widgets.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace collidoscope {

void track(Workspace& workspace, const char* name, const ScreenRect& rect) {
  workspace.widgets.emplace_back(name, rect);
}

void track(Workspace& workspace, const char* name) {
  // Disabled or scrolled-out widgets cannot be clicked.
  if (!ImGui::IsItemVisible() || (ImGui::GetItemFlags() & ImGuiItemFlags_Disabled) != 0) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 low = list->GetClipRectMin(), high = list->GetClipRectMax();
  const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
  const float x = std::max(from.x, low.x), y = std::max(from.y, low.y);
  const float width = std::min(to.x, high.x) - x, height = std::min(to.y, high.y) - y;
  if (width > 0 && height > 0) track(workspace, name, {x, y, width, height});
  if (ImGui::IsItemClicked()) workspace.pressed = name;
}

bool begin_panel(Workspace& workspace, const char* name, const char* title, bool& open) {
  ImGui::PushID(name);
  ImGui::SetNextItemOpen(open);
  open = ImGui::CollapsingHeader(title);
  track(workspace, (std::string("panel.") + name).c_str());
  if (open) ImGui::Spacing();
  return open;
}

void end_panel() {
  ImGui::Spacing();
  ImGui::PopID();
}

void row_label(const char* label, const char* help) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  if (help != nullptr) explain(help);
  const float column = ImGui::GetFontSize() * 6.6f;
  ImGui::SameLine(column);
  ImGui::SetNextItemWidth(-1);
}

void row_text(const char* label, const std::string& value, const char* help) {
  faint_text(label);
  if (help != nullptr) explain(help);
  ImGui::SameLine(ImGui::GetFontSize() * 6.6f);
  ImGui::TextUnformatted(value.c_str());
}

void TextPairs::operator()(const char* label, const std::string& value, const char* help) {
  const float width = ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x;
  const float half = 0.5f * width, pad = ImGui::GetStyle().WindowPadding.x;
  const float left = second_ ? pad + half : pad, name = ImGui::GetFontSize() * 6.6f - pad;
  if (second_) ImGui::SameLine(left);
  faint_text(label);
  if (help != nullptr) explain(help);
  ImGui::SameLine(left + name);
  ImGui::TextUnformatted(value.c_str());
  second_ = !second_;
}

void number_cell(const std::string& text) {
  ImGui::TableNextColumn();
  const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
  if (room > 0) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
  ImGui::TextUnformatted(text.c_str());
}

bool begin_choice(const char* id, const char* chosen) {
  if (!ImGui::BeginCombo(id, chosen)) return false;
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
  return true;
}

void explain(const char* text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 26);
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void faint_text(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
}

std::string grouped_number(std::int64_t number) {
  std::string digits = fmt::format("{}", number);
  const std::size_t first = number < 0 ? 1 : 0;
  for (std::size_t i = digits.size(); i > first + 3;) digits.insert(i -= 3, ",");
  return digits;
}

std::string short_time(double ms) {
  if (!std::isfinite(ms)) return "–";
  return ms < 9.995   ? fmt::format("{:.3f}", ms)
         : ms < 99.95 ? fmt::format("{:.2f}", ms)
                      : fmt::format("{:.1f}", ms);
}

std::string with_prefix(double value, const char* unit) {
  static constexpr struct {
    double scale;
    const char* prefix;
  } prefixes[] = {{1e12, "T"}, {1e9, "G"},  {1e6, "M"},  {1e3, "k"},  {1, ""},
                  {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}, {1e-12, "p"}};
  if (value == 0) return fmt::format("0 {}", unit);
  if (!std::isfinite(value)) return fmt::format("{} {}", value, unit);
  for (const auto& p : prefixes)
    if (std::abs(value) >= p.scale && std::abs(value) < 1e15) {
      // The unit already has the prefix k: "kkg m/s" would be wrong.
      if (unit[0] == 'k') return fmt::format("{:.4g} {}", value, unit);
      return fmt::format("{:.4g} {}{}", value / p.scale, p.prefix, unit);
    }
  return fmt::format("{:.3e} {}", value, unit);
}

std::string component_text(double value) {
  const double size = std::abs(value);
  if (value == 0) return fmt::format("{:9.3f}", 0.0);  // no negative zero
  return size >= 0.0995 && size < 99999.9995 ? fmt::format("{:9.3f}", value) : fmt::format("{:9.2e}", value);
}

std::string bytes_text(std::int64_t bytes) {
  const double size = static_cast<double>(bytes);
  if (bytes < 1 << 20) return fmt::format("{:.1f} KiB", size / 1024);
  if (bytes < std::int64_t{1} << 30) return fmt::format("{:.1f} MiB", size / (1 << 20));
  return fmt::format("{:.2f} GiB", size / (1 << 30));
}

std::uint32_t stage_color(std::size_t stage, bool light) {
  // Adjacent colours of the stack differ in hue and lightness.
  static constexpr std::array<std::uint32_t, stage_colors> dark_theme{
      0xffe8a14fu, 0xff4fb3f5u, 0xff7ac36au, 0xff5a6ee8u, 0xffd184c0u, 0xffc9c04eu, 0xff6f93c4u,
      0xff53d6e4u, 0xffb58af0u, 0xff8fd3a9u, 0xffa6a6a6u, 0xff7fa0ffu, 0xff789000u, 0xfff8d8f8u,
      0xff8840c8u, 0xfff8f818u, 0xffd86080u, 0xff009088u, 0xfff8c0b0u, 0xff887090u};
  static constexpr std::array<std::uint32_t, stage_colors> light_theme{
      0xffb86f1eu, 0xff1f86d0u, 0xff4a9238u, 0xff3a48c4u, 0xff9a4e8cu, 0xff948a1cu, 0xff46658fu,
      0xff1f9fb0u, 0xff8054c4u, 0xff55946cu, 0xff707070u, 0xff4a6cd8u, 0xff005000u, 0xff881050u,
      0xfff87890u, 0xff180078u, 0xff804800u, 0xfff09808u, 0xff680088u, 0xffa888a0u};
  return light ? light_theme[stage % light_theme.size()] : dark_theme[stage % dark_theme.size()];
}

std::string_view stage_term(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 26> terms{
      {{"bounds", "AABBs: axis-aligned bounding boxes of all bodies"},
       {"keys", "Morton codes, or keys of grid cells or planes"},
       {"sort", "sort by key"},
       {"build", "build of the tree or grid"},
       {"pairs", "traversal: pairs of overlapping AABBs"},
       {"contacts", "narrow phase: contact points and normals"},
       {"colour", "graph colouring of the contacts"},
       {"prepare", "constraint setup"},
       {"attractor", "field of the attractors"},
       {"drag", "drag force"},
       {"forces", "external forces and warm starting"},
       {"solve", "constraint solver iterations"},
       {"joints", "joint solver"},
       {"walls", "collision with planes and walls"},
       {"integrate", "higher-order integration of bodies without contacts"},
       {"continuous", "continuous collision: limit of each displacement"},
       {"move", "integration of positions and orientations"},
       {"turn", "rotation of bodies with unequal moments of inertia"},
       {"prescribe", "motion of kinematic bodies"},
       {"relax", "relaxation: iterations without position correction; limit of the energy"},
       {"bounce", "impacts with restitution and friction"},
       {"keep", "warm-start store"},
       {"islands", "islands and sleeping"},
       {"residual", "residuals of the solver"},
       {"guard", "guards: validation of stage results"},
       {"hashes", "hashes of the state, for the timeline and recordings"}}};
  const auto* const found =
      std::ranges::find(terms, name, &std::pair<std::string_view, std::string_view>::first);
  return found == terms.end() ? name : found->second;
}

}  // namespace collidoscope
