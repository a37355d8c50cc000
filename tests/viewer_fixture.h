#pragma once
// The fixture of window tests: the viewer driven by real mouse and key events, its pictures, and its exit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <regex>
#include <string>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/world.h"
#include "tests/window_driver.h"
#include "viewer/render/image.h"

namespace collidoscope {

using Json = nlohmann::json;

/// The state hash of the Box Collider after that many steps, computed without a window.
inline std::string expected_hash(std::int64_t steps, std::int64_t bodies, Variant variant = Variant::paper) {
  Scene scene = read_scene(asset("scenes/box_collider.json").string());
  scene.generators[0].count = bodies;
  scene.generators[0].variant = variant;
  World world(scene, RunOptions{});
  world.step(static_cast<int>(steps));
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(world.state_hash()));
  return text;
}

class Viewer : public testing::Test {
 protected:
  void SetUp() override {
    const std::string reason = window_tests_unavailable_reason();
    if (!reason.empty()) GTEST_SKIP() << reason;
  }

  /// Whether the leak report holds only the small leaks of libraries at exit: Mesa's software renderer leaks
  /// 240 bytes. A repeated leak is larger, and a leak of this program has its name in the stack frames.
  static bool only_others_leak(const std::string& said) {
    static const std::regex summary(R"(SUMMARY: AddressSanitizer: (\d+) byte\(s\) leaked)");
    static const std::regex ours(R"(\n +#\d+ 0x[0-9a-f]+ .*collidoscope)");
    std::smatch bytes;
    return std::regex_search(said, bytes, summary) && std::stoll(bytes[1]) < 1024 &&
           !std::regex_search(said, ours);
  }

  /// Closes the window. Returns "" or what failed.
  static std::string close(WindowDriver& window) {
    const int status = window.end();
    const std::string said = window.errors();
    const bool clean = said.find("OpenGL: cannot") == said.npos && said.find("runtime error") == said.npos;
    if (clean && (status == 0 || (status == 1 && only_others_leak(said)))) return "";
    return "status " + std::to_string(status) + "\n" + said;
  }

  /// A picture of the window, taken with the key P.
  static Image picture(WindowDriver& window) {
    const std::string before = window.frame()["picture"];
    window.key("p");
    EXPECT_TRUE(window.wait_for([&](const Json& f) { return f["picture"] != before; }));
    return read_png(window.file(window.frame()["picture"]));
  }

  /// Returns where the X server's screen differs from the drawn picture, or "". The number of frames per
  /// second changes, so a few pixels of a tile may differ.
  static std::string shown_fault(WindowDriver& window) {
    if (!window.wait_for([](const Json& f) { return f["notice"] == ""; })) return "a notice stays";
    const Image drawn = picture(window);
    if (!window.wait_for([](const Json& f) { return f["notice"] == ""; })) return "a notice stays";
    window.next_frame();
    const Image shown = window.shown();
    if (shown.width != drawn.width || shown.height != drawn.height) return "another size";
    constexpr int tile = 32;
    for (int y0 = 0; y0 < drawn.height; y0 += tile)
      for (int x0 = 0; x0 < drawn.width; x0 += tile) {
        int pixels = 0, changed = 0;
        for (int y = y0; y < std::min(y0 + tile, drawn.height); ++y)
          for (int x = x0; x < std::min(x0 + tile, drawn.width); ++x, ++pixels) {
            const std::size_t at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(drawn.width) +
                                        static_cast<std::size_t>(x));
            int most = 0;
            for (std::size_t k = 0; k < 3; ++k)
              most = std::max(most, std::abs(drawn.rgba[at + k] - shown.rgba[at + k]));
            changed += most > 8;
          }
        if (10 * changed > 4 * pixels)
          return "other pixels than were drawn at (" + std::to_string(x0) + ", " + std::to_string(y0) +
                 "): " + std::to_string(changed) + " of " + std::to_string(pixels);
      }
    return "";
  }

  /// Fraction of the 3D view's pixels that differ.
  static double difference(const Image& a, const Image& b, const Json& frame) {
    EXPECT_EQ(a.rgba.size(), b.rgba.size());
    const Json& rect = frame["widgets"]["scene"];
    const int x0 = rect[0].get<int>(), y0 = rect[1].get<int>(), w = rect[2].get<int>(),
              h = rect[3].get<int>();
    int changed = 0;
    for (int y = y0; y < y0 + h - 60; ++y)  // notices are at the bottom
      for (int x = x0; x < x0 + w; ++x) {
        const std::size_t at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) +
                                    static_cast<std::size_t>(x));
        changed += std::abs(a.rgba[at] - b.rgba[at]) + std::abs(a.rgba[at + 1] - b.rgba[at + 1]) > 12;
      }
    return static_cast<double>(changed) / (static_cast<double>(w) * (h - 60));
  }
};

}  // namespace collidoscope
