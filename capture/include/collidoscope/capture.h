#pragma once
// Picture tests for GoogleTest: compares RGBA pixels in memory with golden PNG files. No dependency on
// OpenGL, on a window system or on the rest of Collidoscope.
//
//   TEST(Triangle, LooksLikeItsGolden) {
//     namespace capture = collidoscope::capture;
//     EXPECT_LOOKS_LIKE("triangle", (capture::Pixels{pixels.data(), 640, 480}), capture::tight());
//   }
//
// A failure says in words what differs and where, and adds the picture to one HTML page. UPDATE_GOLDENS=1 is
// the only way to change golden files. README.md has the details.

#include <gtest/gtest.h>

#include <collidoscope/picture.h>
#include <filesystem>
#include <string>

namespace collidoscope::capture {

/// Of all checks of the program. Set it before the first one.
struct Settings {
  /// Folder of the golden files. Pictures of the tier exact are in the folder itself, others in a folder for
  /// each renderer.
  std::filesystem::path goldens = "golden";
  /// Renderer and version, such as "llvmpipe, Mesa 22.3.6". Set it before a check.
  std::string renderer = "unknown renderer";
  /// Folder of the page and of index.json. Empty: $PICTURE_RESULTS, else picture-results in the folder for
  /// temporary files.
  std::filesystem::path results;
  /// Command that runs one test again, for messages. {} stands for Suite.Test.
  std::string command = "UPDATE_GOLDENS=1 ctest -R '^{}$'";
};
Settings& settings();
/// The folder of the golden files of a renderer: "llvmpipe_Mesa-22.3.6".
std::string folder_of_renderer(const std::string& renderer);

/// Compares with the golden `name`. If there are goldens, but none of this renderer, a tight comparison
/// becomes a loose one with that of another renderer.
testing::AssertionResult looks_like(const std::string& name, const Pixels& pixels,
                                    const Tolerance& tolerance = tight());

#define EXPECT_LOOKS_LIKE(name, ...) EXPECT_TRUE(::collidoscope::capture::looks_like(name, __VA_ARGS__))
#define ASSERT_LOOKS_LIKE(name, ...) ASSERT_TRUE(::collidoscope::capture::looks_like(name, __VA_ARGS__))

}  // namespace collidoscope::capture
