#pragma once
// Builds lines of text.

#include <cstdio>
#include <string>
#include <type_traits>

namespace collidoscope::capture {

inline std::string word(const std::string& text) { return text; }
inline std::string word(const char* text) { return text; }
inline std::string word(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}
template <class Whole>
requires std::is_integral_v<Whole> std::string word(Whole number) { return std::to_string(number); }

/// All parts, one after the other.
template <class... Parts>
std::string words(const Parts&... parts) {
  std::string text;
  ((text += word(parts)), ...);
  return text;
}

inline std::string percent(double share) { return words(100 * share, " %"); }

}  // namespace collidoscope::capture
