// Tests the choice of the golden for a renderer, and the strictness of the comparison.
#include "tests/golden.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* debian12 = "llvmpipe, Mesa 22.3.6, ImGui 1.86";
constexpr const char* debian13 = "llvmpipe, Mesa 25.0.7, ImGui 1.90.1";

Image grey(std::uint8_t level) {
  Image image;
  image.width = image.height = 16;
  for (int pixel = 0; pixel < 16 * 16; ++pixel)
    image.rgba.insert(image.rgba.end(), {level, level, level, 255});
  return image;
}

/// Goldens "box" of two renderers, one dark and one light.
class Goldens : public testing::Test {
 protected:
  Goldens() {
    add(debian12, 40);
    add(debian13, 200);
  }
  void add(const char* key, std::uint8_t level) {
    fs::create_directory(folder_ / golden_folder(key));
    write_png(grey(level), (folder_ / golden_folder(key) / "box.png").string());
  }
  std::string check(const char* key, const std::string& name, const Image& picture) {
    return check_golden(folder_.path(), key, name, picture);
  }

  TemporaryFolder folder_;
};

TEST_F(Goldens, FoldersAreNamedByTheRenderer) {
  EXPECT_EQ(golden_folder(debian12), "llvmpipe_Mesa-22.3.6_ImGui-1.86");
  EXPECT_EQ(golden_folder("NVIDIA H200/PCIe/SSE2, 4.5.0 NVIDIA 580.95, ImGui 1.86"),
            "NVIDIA-H200-PCIe-SSE2_4.5.0-NVIDIA-580.95_ImGui-1.86");
}

TEST_F(Goldens, EachKnownRendererHasItsOwn) {
  EXPECT_EQ(check(debian12, "box", grey(40)), "");
  EXPECT_EQ(check(debian13, "box", grey(200)), "");
  EXPECT_THAT(check(debian13, "box", grey(40)), HasSubstr("of the pixels differ"));
}

TEST_F(Goldens, AKnownRendererIsComparedTightly) {
  Image near = grey(40);
  near.rgba[100] = 60;  // one pixel in 256: more than 0.1 %, but below the loose tolerance
  EXPECT_THAT(check(debian12, "box", near), HasSubstr("of the pixels differ"));
  EXPECT_EQ(check("llvmpipe, Mesa 22.3.7, ImGui 1.86", "box", near), "");
}

TEST_F(Goldens, AMissingOneOfAKnownRendererFailsWithTheCommandThatAcceptsIt) {
  fs::remove(folder_ / golden_folder(debian13) / "box.png");
  EXPECT_THAT(
      check(debian13, "box", grey(40)),
      AllOf(HasSubstr("box.png is missing"),
            HasSubstr("UPDATE_GOLDENS=1 ./dev test -R '^Goldens[.]AMissingOneOfAKnownRendererFails")));
}

TEST_F(Goldens, OneThatNoRendererHasIsMissingEverywhere) {
  EXPECT_THAT(check("softpipe, Mesa 30.0.0, ImGui 1.86", "sphere", grey(40)), HasSubstr("is missing"));
}

TEST_F(Goldens, AnUnknownRendererTakesThoseOfTheSameImGui) {
  EXPECT_EQ(check("softpipe, Mesa 30.0.0, ImGui 1.90.1", "box", grey(200)), "");
  EXPECT_THAT(check("softpipe, Mesa 30.0.0, ImGui 1.90.1", "box", grey(40)), HasSubstr("perceptual mean"));
  EXPECT_EQ(check("softpipe, Mesa 30.0.0, ImGui 1.99", "box", grey(40)), "");
}

}  // namespace
}  // namespace collidoscope
