// Tests the library of picture tests (capture/): the comparison, the choice of golden files, and the page.

#include <collidoscope/capture.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>

#include "tests/run_program.h"
#include "tests/test_files.h"

namespace collidoscope::capture {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

/// A picture whose pixels are color(x, y, channel).
template <class Color>
Picture picture_of(int width, int height, const Color& color) {
  Picture picture{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int channel = 0; channel < 4; ++channel)
        picture.rgba.push_back(channel == 3 ? 255 : static_cast<std::uint8_t>(color(x, y, channel)));
  return picture;
}

Picture grey(int level, int side = 16) {
  return picture_of(side, side, [&](int, int, int) { return level; });
}

void fill(Picture& picture, const Region& at, int level) {
  for (int y = at.y; y < at.y + at.height; ++y)
    for (int x = at.x; x < at.x + at.width; ++x)
      for (int channel = 0; channel < 3; ++channel)
        picture.rgba[static_cast<std::size_t>(4 * (y * picture.width + x) + channel)] =
            static_cast<std::uint8_t>(level);
}

Comparison compared(const Picture& actual, const Picture& expected, const Tolerance& tolerance) {
  return compare(actual.pixels(), expected.pixels(), tolerance);
}

// ---- FLIP ----

struct FlipPair {
  Picture a, b;
  double mean;  ///< by NVIDIA's program (FLIP 1.7, C++)
};
FlipPair flip_pair(int number) {
  constexpr int width = 320, height = 200;
  std::mt19937 random(1);
  const auto make = [&](const auto& a, const auto& b, double mean) {
    return FlipPair{picture_of(width, height, a), picture_of(width, height, b), mean};
  };
  switch (number) {
    case 0:  // gradients, shifted by three pixels
      return make([](int x, int, int c) { return (x * 255 / 320 + c * 60) % 256; },
                  [](int x, int, int c) { return ((x + 3) * 255 / 320 + c * 60) % 256; }, 0.1289307);
    case 1:  // a rectangle of another colour
      return make([](int, int, int c) { return 40 + 10 * c; },
                  [](int x, int y, int c) {
                    return x > 100 && x < 130 && y > 50 && y < 90 ? 200 - 50 * c : 40 + 10 * c;
                  },
                  0.0222429);
    default:  // a chequered pattern, shifted by a pixel
      return make([](int x, int y, int c) { return ((x / 8 + y / 8) & 1) != 0 ? 230 : 20 * c; },
                  [](int x, int y, int c) { return (((x + 1) / 8 + y / 8) & 1) != 0 ? 230 : 20 * c; },
                  0.2878383);
  }
}

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

TEST(Flip, AgreesWithNvidiasProgram) {
  for (int number = 0; number < 3; ++number) {
    const FlipPair pair = flip_pair(number);
    EXPECT_NEAR(mean_of(flip(pair.a.pixels(), pair.b.pixels())), pair.mean, 5e-6) << number;
  }
}

TEST(Flip, IsZeroAwayFromTheDifferenceAndSymmetric) {
  const FlipPair pair = flip_pair(1);
  const std::vector<float> error = flip(pair.a.pixels(), pair.b.pixels());
  EXPECT_EQ(error, flip(pair.b.pixels(), pair.a.pixels()));
  EXPECT_EQ(error[0], 0);
  EXPECT_EQ(error[70 * 320 + 150], 0) << "20 pixels beside the rectangle";
  EXPECT_GT(error[70 * 320 + 115], 0.3f);
  EXPECT_EQ(mean_of(flip(pair.a.pixels(), pair.a.pixels())), 0);
}

/// A part of a picture that touches its edge has the same error as in the whole picture.
TEST(Flip, AtTheEdgeRepeatsPixels) {
  const Picture a = grey(100, 60);
  Picture b = a;
  fill(b, {0, 0, 3, 60}, 200);
  const std::vector<float> error = flip(a.pixels(), b.pixels());
  for (int y = 1; y < 60; ++y) EXPECT_FLOAT_EQ(error[static_cast<std::size_t>(60 * y)], error[0]) << y;
}

// ---- tiers ----

TEST(PictureComparison, NamesIdsThatMoved) {
  const auto ids = [](int first, int second) {
    Picture picture = picture_of(100, 60, [](int, int, int) { return 0; });
    for (int y = 10; y < 20; ++y)
      for (int x = 0; x < 8; ++x) {
        picture.rgba[static_cast<std::size_t>(4 * (100 * y + first + x))] = 17;
        if (second > 0) picture.rgba[static_cast<std::size_t>(4 * (100 * (y + 20) + second + x))] = 4;
      }
    return picture;
  };
  Tolerance tolerance = exact();
  tolerance.name_of_id = [](std::uint32_t id) { return "body " + std::to_string(id & 0xffffff); };
  EXPECT_TRUE(compared(ids(30, 60), ids(30, 60), tolerance).passed);
  const Comparison moved = compared(ids(33, 60), ids(30, 60), tolerance);
  EXPECT_FALSE(moved.passed);
  EXPECT_EQ(moved.text, "60 pixels have other ids: body 17 moved by 3 pixels (right 3, down 0)");
  EXPECT_THAT(compared(ids(30, 0), ids(30, 60), tolerance).text, HasSubstr("body 4 is missing (80 pixels)"));
  EXPECT_THAT(compared(ids(30, 60), ids(30, 0), tolerance).text, HasSubstr("body 4 is new (80 pixels)"));
}

TEST(PictureComparison, SaysHowManyPixelsDifferAndWhere) {
  const Picture expected = grey(100, 100);
  Picture actual = expected;
  fill(actual, {70, 80, 5, 4}, 105);
  EXPECT_TRUE(compared(actual, expected, tight()).passed) << "5 of 255";
  fill(actual, {70, 80, 5, 4}, 107);
  const Comparison different = compared(actual, expected, tight());
  EXPECT_FALSE(different.passed);
  EXPECT_EQ(different.beyond, 20);
  EXPECT_EQ(different.text,
            "0.2 % of the pixels (20) differ by more than 5 of 255, at most 0.1 % may; the largest "
            "difference is 7; "
            "x 70 to 74, y 80 to 83, in the lower right");
  EXPECT_TRUE(compared(actual, expected, tight(5, 0.002)).passed);
  EXPECT_TRUE(compared(actual, expected, tight(7)).passed);
  Tolerance ignoring = tight();
  ignoring.ignored = {{68, 78, 30, 30}};
  EXPECT_TRUE(compared(actual, expected, ignoring).passed);
  ignoring.ignored = {{68, 78, 4, 30}};
  EXPECT_EQ(compared(actual, expected, ignoring).beyond, 12);
}

TEST(PictureComparison, ASmallMissingObjectCannotHideInTheMean) {
  const Picture expected = grey(128, 200);
  Picture actual = expected;
  fill(actual, {90, 90, 25, 25}, 200);
  const Comparison found = compared(actual, expected, loose());
  EXPECT_LT(found.flip_mean, 0.02);
  EXPECT_FALSE(found.passed) << found.flip_p99;
  EXPECT_THAT(found.text, HasSubstr("the 99th percentile"));
  Picture rounded = expected;
  fill(rounded, {0, 0, 200, 60}, 129);
  EXPECT_TRUE(compared(rounded, expected, loose()).passed) << "another rounding in a third of the picture";
}

/// A steep line, whose edge pixels are mixed from both sides.
Picture slanted_edge(double shift) {
  return picture_of(120, 120, [&](int x, int y, int) {
    return 20 + 215 * std::clamp(x - (30 + 0.3 * y + shift), 0.0, 1.0);
  });
}

TEST(PictureComparison, AntialiasedEdgesCanBeIgnored) {
  const Picture expected = slanted_edge(0), actual = slanted_edge(0.4);
  EXPECT_FALSE(compared(actual, expected, tight()).passed);
  Tolerance tolerance = tight();
  tolerance.ignore_antialiasing = true;
  EXPECT_TRUE(compared(actual, expected, tolerance).passed);
  Picture block = expected;
  fill(block, {80, 80, 6, 6}, 100);
  EXPECT_FALSE(compared(block, expected, tolerance).passed) << "no edge is there";
}

TEST(PictureComparison, OtherSizesDiffer) {
  EXPECT_EQ(compared(grey(1, 16), grey(1, 17), tight()).text, "16x16 pixels, expected 17x17");
}

TEST(PictureComparison, RowsMayBeApart) {
  const Picture padded = picture_of(20, 10, [](int x, int, int) { return x < 16 ? 7 : 99; });
  const Picture plain = picture_of(16, 10, [](int, int, int) { return 7; });
  EXPECT_TRUE(compare({padded.rgba.data(), 16, 10, 80}, plain.pixels(), exact()).passed);
}

TEST(PictureSensitivity, IsTheSmallestBlockThatIsNoticed) {
  const Picture picture = grey(128, 200);
  EXPECT_EQ(smallest_detected_block(picture.pixels(), exact()), 1);
  EXPECT_EQ(smallest_detected_block(picture.pixels(), tight()), 7) << "49 pixels of 40,000 are above 0.1 %";
  EXPECT_EQ(smallest_detected_block(picture.pixels(), tight(5, 0.01)), 21);
  EXPECT_GT(smallest_detected_block(picture.pixels(), tight(255)), 200) << "notices nothing";
  Tolerance all = exact();
  all.ignored = {{0, 0, 200, 200}};
  EXPECT_GT(smallest_detected_block(picture.pixels(), all), 200);
}

// ---- golden files ----

constexpr const char* debian12 = "llvmpipe, Mesa 22.3.6, ImGui 1.86";
constexpr const char* debian13 = "llvmpipe, Mesa 25.0.7, ImGui 1.90.1";

/// Sets a variable of the environment, and restores it.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_ ? before_->c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const char* value) const { value != nullptr ? setenv(name_, value, 1) : unsetenv(name_); }
  const char* name_;
  std::optional<std::string> before_;
};

/// Goldens "box" of two renderers, one dark and one light.
class PictureGoldens : public testing::Test {
 protected:
  PictureGoldens() : before_(settings()) {
    settings() = {};
    settings().goldens = folder_ / "golden";
    settings().results = folder_ / "results";
    add(debian12, 40);
    add(debian13, 200);
  }
  ~PictureGoldens() override { settings() = before_; }
  void add(const char* renderer, int level) const {
    write_png(grey(level).pixels(), settings().goldens / folder_of_renderer(renderer) / "box.png");
  }
  static std::string check(const char* renderer, const std::string& name, const Picture& picture,
                           const Tolerance& tolerance = tight()) {
    settings().renderer = renderer;
    const testing::AssertionResult result = looks_like(name, picture.pixels(), tolerance);
    return result ? "" : result.message();
  }
  std::string page() const { return text_of(folder_ / "results" / "index.html"); }

  TemporaryFolder folder_;
  Settings before_;
  Variable not_updating_{"UPDATE_GOLDENS", nullptr}, not_in_ci_{"CI", nullptr};
};

TEST_F(PictureGoldens, AreInAFolderOfTheRenderer) {
  EXPECT_EQ(folder_of_renderer(debian12), "llvmpipe_Mesa-22.3.6_ImGui-1.86");
  EXPECT_EQ(folder_of_renderer("NVIDIA H200/PCIe/SSE2, 4.5.0 NVIDIA 580.95, ImGui 1.86"),
            "NVIDIA-H200-PCIe-SSE2_4.5.0-NVIDIA-580.95_ImGui-1.86");
  EXPECT_EQ(check(debian12, "box", grey(40)), "");
  EXPECT_EQ(check(debian13, "box", grey(200)), "");
  EXPECT_THAT(check(debian13, "box", grey(40)), HasSubstr("differ by more than 5 of 255"));
}

TEST_F(PictureGoldens, OfAnotherRendererAreComparedLoosely) {
  Picture near = grey(40);
  fill(near, {5, 5, 1, 1}, 60);  // one pixel in 256: more than 0.1 %, but below the loose tolerance
  EXPECT_THAT(check(debian12, "box", near), HasSubstr("differ by more than 5 of 255"));
  EXPECT_EQ(check("llvmpipe, Mesa 22.3.7, ImGui 1.86", "box", near), "");
  // Those with the same last part, here the version of ImGui, are preferred.
  EXPECT_EQ(check("softpipe, Mesa 30.0.0, ImGui 1.90.1", "box", grey(200)), "");
  EXPECT_THAT(check("softpipe, Mesa 30.0.0, ImGui 1.90.1", "box", grey(40)),
              HasSubstr("golden of another renderer"));
  EXPECT_EQ(check("softpipe, Mesa 30.0.0, ImGui 1.99", "box", grey(40)), "");
}

TEST_F(PictureGoldens, OfTheTierExactAreThoseOfAllRenderers) {
  write_png(grey(9).pixels(), settings().goldens / "ids.png");
  EXPECT_EQ(check("any renderer", "ids", grey(9), exact()), "");
  EXPECT_THAT(check("any renderer", "ids", grey(8), exact()), HasSubstr("have other ids"));
}

TEST_F(PictureGoldens, ThatAreMissingFailWithTheCommandThatAcceptsThePicture) {
  fs::remove(settings().goldens / folder_of_renderer(debian13) / "box.png");
  const std::string text = check(debian13, "box", grey(40));
  EXPECT_THAT(text, HasSubstr("box.png is missing; to accept the picture: UPDATE_GOLDENS=1 ctest -R "
                              "'^PictureGoldens[.]ThatAreMissingFail"));
  EXPECT_THAT(check("softpipe", "sphere", grey(40)), HasSubstr("is missing")) << "no renderer has it";
  std::ofstream(settings().goldens / folder_of_renderer(debian12) / "box.png") << "no picture";
  EXPECT_THAT(check(debian12, "box", grey(40)), HasSubstr("expected a complete PNG image"));
}

TEST_F(PictureGoldens, AreWrittenOnlyOnRequestAndIfTheyChanged) {
  const fs::path file = settings().goldens / folder_of_renderer(debian12) / "box.png";
  const auto bytes = text_of(file);
  EXPECT_THAT(check(debian12, "box", grey(90)), Not(""));
  EXPECT_EQ(text_of(file), bytes);
  const Variable updating("UPDATE_GOLDENS", "1");
  {
    const Variable in_ci("CI", "true");
    EXPECT_THAT(check(debian12, "box", grey(90)), HasSubstr("refused, because CI is set"));
    EXPECT_EQ(text_of(file), bytes);
  }
  EXPECT_EQ(check(debian12, "box", grey(43)), "");
  EXPECT_EQ(text_of(file), bytes) << "within the tolerance";
  EXPECT_EQ(check(debian12, "box", grey(90)), "");
  EXPECT_EQ(read_png(file).rgba, grey(90).rgba);
  EXPECT_EQ(check("new renderer", "box", grey(90)), "") << "a golden of its own";
  EXPECT_TRUE(fs::exists(settings().goldens / "new-renderer" / "box.png"));
}

TEST_F(PictureGoldens, ATestThatNoticesTooLittleFails) {
  Tolerance tolerance = tight(5, 0.2);
  tolerance.must_detect = 8;
  EXPECT_EQ(check(debian12, "box", grey(40), tolerance), "");
  tolerance.must_detect = 7;
  EXPECT_THAT(
      check(debian12, "box", grey(40), tolerance),
      HasSubstr("would not notice a block of 7 x 7 pixels of another colour; the smallest that it notices "
                "has 8 x 8: use a smaller tolerance"));
}

TEST_F(PictureGoldens, FailuresAreOnOnePageTheWorstFirst) {
  Picture slightly = grey(40);
  fill(slightly, {0, 0, 2, 2}, 50);
  const std::string text = check(debian12, "box", slightly);
  EXPECT_THAT(text, HasSubstr("; see " + (folder_ / "results" / "index.html").string()));
  check(debian12, "missing <picture>", grey(3));
  const std::string html = page();
  EXPECT_LT(html.find("missing &lt;picture>"), html.find("<h2>box</h2>"));
  EXPECT_THAT(html, Not(HasSubstr("<picture>")));
  EXPECT_THAT(html, HasSubstr("UPDATE_GOLDENS=1 ctest -R"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(html, Not(HasSubstr("src=\"/"))) << "the page needs no other file";
  const nlohmann::json list = nlohmann::json::parse(text_of(folder_ / "results" / "index.json"));
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[1]["name"], "box");
  EXPECT_EQ(list[1]["beyond"], 4);
  EXPECT_EQ(list[1]["where"], (nlohmann::json{0, 0, 2, 2}));
  // A picture that passes again is removed.
  EXPECT_EQ(check(debian12, "box", grey(40)), "");
  EXPECT_THAT(page(), Not(HasSubstr("<h2>box</h2>")));
}

TEST(PictureFiles, KeepAllPixels) {
  const TemporaryFolder folder;
  Picture picture = picture_of(31, 7, [](int x, int y, int c) { return x * 8 + y + c; });
  write_png(picture.pixels(), folder / "opaque.png");
  EXPECT_EQ(read_png(folder / "opaque.png").rgba, picture.rgba);
  picture.rgba[3] = 12;
  write_png(picture.pixels(), folder / "alpha.png");
  EXPECT_EQ(read_png(folder / "alpha.png").rgba, picture.rgba);
  EXPECT_THROW(read_png(folder / "none.png"), std::runtime_error);
}

}  // namespace
}  // namespace collidoscope::capture
