#include "ui/number_field.h"

#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>

#include "ui/widgets.h"

namespace collidoscope {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr const char* blanks = " \t";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == text.npos) return "";
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// The text without thousands separators, "134,217,728" as "134217728". Unchanged if they are misplaced.
std::string ungrouped(std::string_view text) {
  std::string digits(text);
  std::erase(digits, ',');
  std::int64_t read = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), read);
  const bool whole = error == std::errc{} && stop == digits.data() + digits.size();
  return whole && grouped_number(read) == text ? digits : std::string(text);
}

/// A whole number with decimal point or exponent ("1e3") in plain digits. Any other text is unchanged.
std::string without_exponent(const std::string& text) {
  double read = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), read);
  const bool whole = error == std::errc{} && stop == text.data() + text.size() && read == std::trunc(read) &&
                     std::abs(read) < 1e15 && text.find_first_of(".eE") != text.npos;
  return whole ? fmt::format("{:.0f}", read) : text;
}

std::string number_text(std::int64_t value) { return grouped_number(value); }
std::string number_text(std::uint64_t value) { return fmt::format("{}", value); }
std::string number_text(double value) { return fmt::format("{:g}", value); }

template <class Number>
std::string allowed_text(const NumberRange<Number>& range) {
  const bool has_unit = *range.unit != 0;
  return fmt::format("{}{} to {}{}{}{}", std::is_integral_v<Number> ? "a whole number from " : "",
                     number_text(range.low), number_text(range.high), has_unit ? " " : "", range.unit,
                     range.zero_is_auto ? ", or auto" : "");
}

bool escape_pressed() {
#if IMGUI_VERSION_NUM >= 18700
  return ImGui::IsKeyPressed(ImGuiKey_Escape);
#else
  return ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
#endif
}

}  // namespace

template <class Number>
std::string read_number(std::string_view text, const NumberRange<Number>& range, Number& value) {
  const std::string_view whole = trimmed(text);
  if (range.zero_is_auto && whole == "auto") {
    value = 0;
    return "";
  }
  std::string plain = ungrouped(whole);
  if (std::is_integral_v<Number>) plain = without_exponent(plain);
  std::string_view digits = plain;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  Number read{};
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), read);
  const std::string_view rest = trimmed(digits.substr(static_cast<std::size_t>(stop - digits.data())));
  const bool negative = std::is_unsigned_v<Number> && digits.starts_with('-');
  const bool is_number = error != std::errc::invalid_argument && (rest.empty() || rest == range.unit);
  if (!is_number && !negative)
    return fmt::format("'{}' is not {}; allowed: {}", whole,
                       std::is_integral_v<Number> ? "a whole number" : "a number", allowed_text(range));
  if (range.zero_is_auto && error == std::errc{} && read == 0) {
    value = 0;
    return "";
  }
  if (negative || error != std::errc{} || !(read >= range.low && read <= range.high))
    return fmt::format("{} is out of range; allowed: {}", whole, allowed_text(range));
  value = read == 0 ? Number{} : read;  // no negative zero
  return "";
}

template <class Number>
bool number_field(Workspace& workspace, const char* name, const char* label, Number& value,
                  const NumberRange<Number>& range, const char* format) {
  const std::string before = fmt::format(fmt::runtime(format), value);
  std::array<char, 128> shown{};
  before.copy(shown.data(), shown.size() - 1);
  ImGui::InputText("##value", shown.data(), shown.size(), ImGuiInputTextFlags_AutoSelectAll);
  const bool active = ImGui::IsItemActive(), over = ImGui::IsItemDeactivatedAfterEdit();
  std::string& typed = workspace.typed_text;
  if (ImGui::IsItemActivated()) {
    typed = before;
    workspace.input_fault.reset();
  }
  // When another widget takes the focus, ImGui restores the old text before it reports the end of the edit.
  if (active || (over && shown.data() != before)) typed = shown.data();
  track(workspace, name);
  if (!over || escape_pressed() || typed == before) return false;
  Number read = value;
  const std::string fault = read_number(typed, range, read);
  if (!fault.empty()) {
    workspace.input_fault = {name, fmt::format("{}: {}", label, fault)};
    return false;
  }
  value = read;
  return true;
}

void draw_input_fault(Workspace& workspace, const char* name) {
  if (!workspace.input_fault || workspace.input_fault->widget != name) return;
  const bool light = workspace.theme == Theme::light;
  ImGui::PushStyleColor(ImGuiCol_Text, light ? ImVec4(0.72f, 0.12f, 0.10f, 1) : ImVec4(1, 0.52f, 0.47f, 1));
  std::string text = workspace.input_fault->text;
  const std::string_view range = "; allowed: ";
  if (const std::size_t at = text.find(range); at != text.npos) text.replace(at, 2, ".\n");
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

template std::string read_number(std::string_view, const NumberRange<std::int64_t>&, std::int64_t&);
template std::string read_number(std::string_view, const NumberRange<std::uint64_t>&, std::uint64_t&);
template std::string read_number(std::string_view, const NumberRange<double>&, double&);
template bool number_field(Workspace&, const char*, const char*, std::int64_t&,
                           const NumberRange<std::int64_t>&, const char*);
template bool number_field(Workspace&, const char*, const char*, std::uint64_t&,
                           const NumberRange<std::uint64_t>&, const char*);
template bool number_field(Workspace&, const char*, const char*, double&, const NumberRange<double>&,
                           const char*);

}  // namespace collidoscope
