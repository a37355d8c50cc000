#include "tests/window_walker.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace collidoscope {

void WindowWalker::step() {
  const Json now = window_.frame(), &widgets = now["widgets"];
  for (const auto& [name, rect] : widgets.items())
    widgets_[name].x = rect[0].get<double>() + 0.5 * rect[2].get<double>();
  if (widgets.empty()) return key();
  remember_choices(now);
  auto any = widgets.begin();
  std::advance(any, static_cast<std::ptrdiff_t>(pick(widgets.size())));

  const std::string hidden = out_of_sight(widgets);
  const std::size_t dice = pick(16);
  if (!open_list_.empty()) {
    while (!any.key().starts_with(open_list_ + "."))
      if (++any == widgets.end()) any = widgets.begin();
    dice < (hidden.empty() ? 5 : 8) ? wheel(any.key(), *any) : touch(widgets);
  } else if (dice < 2) {
    key();
  } else if (dice == 2) {
    wheel(any.key(), *any);
  } else if (dice == 3) {
    pick(4) == 0 ? resize() : choose_body(widgets);
  } else if (dice < 9 && !hidden.empty()) {
    seek(hidden, now);
  } else {
    touch(widgets);
  }
}

/// Brings a widget into view: scrolls its column, unfolds its panel, or selects a body.
void WindowWalker::seek(const std::string& name, const Json& now) {
  const Json& widgets = now["widgets"];
  const std::string part = name.substr(0, name.find('.')), panel = "panel." + part;
  const auto in_sight = [&](const std::string& prefix) {
    return std::ranges::any_of(widgets.items(), [&](const auto& w) { return w.key().starts_with(prefix); });
  };
  if (part != "settings" && part != "layers" && now["selection"].is_null() && pick(3) == 0)
    return choose_body(widgets);
  if (!in_sight(part + ".") && pick(2)) {
    static constexpr const char* visible_panels[] = {"fold.left", "fold.right", "fold.bottom"};
    const std::string fold =
        widgets.contains(panel) ? panel : visible_panels[pick(std::size(visible_panels))];
    if (widgets.contains(fold)) return act_on(fold, widgets[fold]);
  }
  auto nearest = widgets.end();
  const auto distance = [&](const std::string& other) {
    return std::abs(widgets_[other].x - widgets_[name].x);
  };
  for (auto at = widgets.begin(); at != widgets.end(); ++at)
    if (!at.key().starts_with("fold.") &&  // the bottom bar does not scroll
        (nearest == widgets.end() || distance(at.key()) < distance(nearest.key())))
      nearest = at;
  if (nearest != widgets.end()) wheel(nearest.key(), *nearest);
}

/// Records the visible choices of the open list; long lists scroll.
void WindowWalker::remember_choices(const Json& now) {
  if (now["list_open"] == false) open_list_.clear();
  if (open_list_.empty()) return;
  std::set<std::string> seen;
  for (const auto& [name, rect] : now["widgets"].items())
    if (name.starts_with(open_list_ + ".")) seen.insert(name);
  choices_[open_list_].insert(seen.begin(), seen.end());
  if (seen.empty()) open_list_.clear();
}

int WindowWalker::within(const Json& rect, std::size_t axis, double from, double to) {
  const double share = from + (to - from) * static_cast<double>(pick(1000)) / 1000;
  return static_cast<int>(rect[axis].get<double>() + share * rect[axis + 2].get<double>());
}

int WindowWalker::wear(const std::string& name) const {
  // A touch that another widget received counts little, so that the walker does not return at once.
  const auto of = [&](const std::string& n) {
    const auto found = widgets_.find(n);
    return found == widgets_.end() ? 0 : found->second.touches + 2 * found->second.presses;
  };
  const auto list = choices_.find(name);
  if (list == choices_.end()) return of(name);
  int least = of(name);
  for (const std::string& choice : list->second) least = std::min(least, of(choice));
  return least;
}

std::string WindowWalker::out_of_sight(const Json& widgets) {
  std::string least;
  std::pair<int, bool> least_worn;
  for (const auto& [name, widget] : widgets_) {
    if (!open_list_.empty() && !choices_[open_list_].contains(name)) continue;
    const std::pair worn(wear(name), !widgets.contains(name));
    if (least.empty() || worn < least_worn) {
      least = name;
      least_worn = worn;
    }
  }
  return least_worn.second ? least : "";
}

void WindowWalker::key() {
  static constexpr const char* keys[] = {
      "space",        "s",     "r",       "f", "1",      "3",       "5",           "7", "Escape",
      "F1",           "Tab",   "shift+f", "w", "Return", "shift+s", "shift+space", "b", "bracketleft",
      "bracketright", "ctrl+s"};
  const std::string name = keys[pick(std::size(keys))];
  note(name);
  window_.key(name);
}

void WindowWalker::wheel(const std::string& over, const Json& rect) {
  note("wheel:" + over);
  window_.hands({"mousemove", std::to_string(within(rect, 0)), std::to_string(within(rect, 1)), "click",
                 "--delay", "4", "--repeat", std::to_string(1 + pick(12)), pick(2) ? "4" : "5"});
  window_.next_frame();
}

void WindowWalker::resize() {
  static constexpr int sizes[][2] = {{1100, 960}, {1280, 720}, {640, 480}, {320, 240}, {1500, 1100}};
  const auto& [width, height] = sizes[pick(std::size(sizes))];
  note(std::to_string(width) + "x" + std::to_string(height));
  window_.resize(width, height);
  // A very small window hides most widgets, and a very large one is slow to draw.
  if (width < 1000 || width > 1300) window_.resize(1100, 960);
}

/// Clicks in the middle of the view, where most bodies are.
void WindowWalker::choose_body(const Json& widgets) {
  if (!widgets.contains("scene")) return;
  const Json& rect = widgets["scene"];
  note("body");
  if (pick(2)) window_.key("shift+f");  // recentres the camera
  window_.click_at(within(rect, 0, 0.4, 0.6), within(rect, 1, 0.5, 0.7));
}

void WindowWalker::touch(const Json& widgets) {
  std::vector<std::string> names;
  for (const auto& [name, rect] : widgets.items())
    // A click elsewhere closes the list.
    if (open_list_.empty() || choices_[open_list_].contains(name)) names.push_back(name);
  std::ranges::shuffle(names, random_);
  const std::string name = pick(4) == 0
                               ? names.front()
                               : *std::ranges::min_element(names, {}, [&](const auto& n) { return wear(n); });
  for (const std::string& offered : names) ++widgets_[offered].offers;
  ++touches_;
  ++widgets_[name].touches;
  note(name);
  act_on(name, widgets[name]);

  const Json& after = window_.next_frame();
  if (after["pressed"] == name) ++widgets_[name].presses;
  open_list_ = after["list_open"] == true ? name : "";
}

void WindowWalker::act_on(const std::string& name, const Json& rect) {
  // Few bodies have no contacts, and a frame of a million takes seconds, so N stays between 50 and 6,000. The
  // same applies to many iterations.
  const bool number = name == "settings.bodies.slider";
  const bool sweeps = name == "settings.substeps.slider" || name == "settings.iterations.slider";
  const double from = number ? 0.4 : 0, to = number ? 0.6 : sweeps ? 0.4 : 1;
  const int x = within(rect, 0, from, to), y = within(rect, 1);
  static const std::set<std::string> fields{"settings.bodies", "settings.blocks", "settings.threads",
                                            "settings.rate",   "settings.radius", "settings.seed"};
  if (fields.contains(name) && pick(2)) {
    static constexpr const char* texts[] = {"0",   "1",  "1000", "250",      "800",
                                            "600", "-3", "0.5",  "nonsense", "1e2"};
    window_.click_at(x, y);
    window_.type(texts[pick(std::size(texts))]);
  } else if (pick(4) == 0) {
    window_.drag(x, y, within(rect, 0, from, to), within(rect, 1), pick(3) == 0 ? 3 : 1);
  } else {
    window_.click_at(x, y);
  }
}

}  // namespace collidoscope
