#include "viewer/render/frame_layers.h"

#include <charconv>
#include <vector>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

// Parses the whole of `text` as a level, 0 to 63.
bool parse_level(std::string_view text, int& level) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), level);
  return error == std::errc{} && end == text.data() + text.size() && level >= 0 && level <= 63;
}

// Parses `bvh`, `bvh:A` or `bvh:A-B`.
bool parse_boxes(std::string_view text, FrameLayers& layers) {
  layers.boxes = true;
  if (text == "bvh") return true;
  text.remove_prefix(4);
  const std::size_t dash = text.find('-');
  if (!parse_level(text.substr(0, dash), layers.first_level)) return false;
  layers.last_level = layers.first_level;
  if (dash != text.npos && !parse_level(text.substr(dash + 1), layers.last_level)) return false;
  return layers.first_level <= layers.last_level;
}

// Parses `errors` or `errors:A`.
bool parse_error_scale(std::string_view text, int& scale) {
  if (text == "errors") return true;
  text.remove_prefix(7);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), scale);
  return error == std::errc{} && end == text.data() + text.size() && scale >= 1 && scale <= 1'000'000'000;
}

}  // namespace

FrameLayers parse_layers(const std::string& text, const std::string& where) {
  FrameLayers layers;
  std::vector<std::string> faults;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string name = text.substr(from, to - from);
    from = to + 1;
    if (name == "spheres") {
      layers.spheres = true;
    } else if (name == "contacts") {
      layers.contacts = true;
    } else if (name == "grid" || name == "no-grid") {
      layers.grid = name == "grid";
    } else if (name == "walls" || name == "no-walls") {
      layers.walls = name == "walls";
    } else if (name == "joints" || name == "no-joints") {
      layers.joints = name == "joints";
    } else if (name == "ghosts") {
      layers.ghosts = true;
    } else if (name == "errors" || name.starts_with("errors:")) {
      layers.errors = true;
      if (!parse_error_scale(name, layers.error_scale))
        faults.push_back(where + ": '" + name +
                         "': not a magnification; expected errors or errors:A with a whole number 1 <= A <= "
                         "1000000000, such as errors:100");
    } else if (name == "overlay" || name == "no-overlay") {
      layers.overlay = name == "overlay";
    } else if (name == "bvh" || name.starts_with("bvh:")) {
      if (layers.boxes)
        faults.push_back(where + ": '" + name + "': second range of levels; give only one, such as bvh:2-5");
      else if (!parse_boxes(name, layers))
        faults.push_back(where + ": '" + name +
                         "': not a range of levels; expected bvh, bvh:A or bvh:A-B with 0 <= A <= B <= 63, "
                         "such as bvh:2-5");
    } else if (name == "ui" || name == "ui:tree" || name == "ui:convergence") {
      layers.ui = true;
      layers.tree = name == "ui:tree";
      layers.convergence = name == "ui:convergence";
    } else {
      faults.push_back(
          where + ": '" + name +
          "': unknown layer; expected one of spheres, bvh, bvh:A-B, contacts, ghosts, errors, errors:A, ui, "
          "ui:tree, ui:convergence, grid, walls, joints, overlay, no-grid, no-walls, no-joints, no-overlay");
    }
  }
  if (!faults.empty()) throw InputError(faults);
  return layers;
}

BodyColor parse_body_color(const std::string& text, const std::string& where) {
  static constexpr struct {
    const char* name;
    BodyColor color;
  } names[] = {{"speed", BodyColor::speed},       {"radius", BodyColor::radius}, {"id", BodyColor::id},
               {"contacts", BodyColor::contacts}, {"order", BodyColor::order},   {"depth", BodyColor::depth},
               {"visits", BodyColor::visits},     {"sleep", BodyColor::sleep},   {"error", BodyColor::error}};
  for (const auto& known : names)
    if (text == known.name) return known.color;
  throw InputError(
      where + ": '" + text +
      "': unknown colour; expected one of speed, radius, id, contacts, order, depth, visits, sleep, error");
}

NodeMetric parse_box_color(const std::string& text, const std::string& where) {
  static constexpr struct {
    const char* name;
    NodeMetric metric;
  } names[] = {{"level", NodeMetric::level},
               {"sah", NodeMetric::sah_share},
               {"overlap", NodeMetric::sibling_overlap},
               {"empty", NodeMetric::empty_space},
               {"visits", NodeMetric::visits}};
  for (const auto& known : names)
    if (text == known.name) return known.metric;
  throw InputError(where + ": '" + text +
                   "': unknown colour of boxes; expected one of level, sah, overlap, empty, visits");
}

void parse_box_range(const std::string& text, FrameLayers& layers, const std::string& where) {
  const std::size_t comma = text.find(',');
  const auto read = [&](std::size_t from, std::size_t to, float& value) {
    const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
    return error == std::errc{} && end == text.data() + to && value >= 0;
  };
  float low = 0, high = 0;
  if (comma == text.npos || !read(0, comma, low) || !read(comma + 1, text.size(), high) || low > high)
    throw InputError(where + ": '" + text +
                     "': not a range of values; expected LOW,HIGH with 0 <= LOW <= HIGH, such as 100,inf");
  layers.box_low = low;
  layers.box_high = high;
}

}  // namespace collidoscope
