// Tests the PNG reader and writer: a picture survives the round trip, and files that are no pictures are
// refused.
#include "viewer/render/image.h"

#include <gmock/gmock.h>

#include <fstream>

#include "sim_cuda/core/error.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

Image gradient(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c : {x * 7, y * 5, x * y, 255}) image.rgba.push_back(static_cast<std::uint8_t>(c));
  return image;
}

TEST(Image, ComesBackFromAFileAsItWas) {
  const TemporaryFolder folder;
  const Image image = gradient(37, 19);
  write_png(image, (folder / "a.png").string());
  EXPECT_EQ(read_png((folder / "a.png").string()), image);
}

TEST(Image, LeavesNothingButTheFile) {
  const TemporaryFolder folder;
  write_png(gradient(8, 8), (folder / "a.png").string());
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_EQ(entry.path().filename(), "a.png");
    ++files;
  }
  EXPECT_EQ(files, 1);
  EXPECT_THROW(write_png(gradient(8, 8), (folder / "no/such/a.png").string()), MachineError);
}

TEST(Image, RefusesWhatIsNoPicture) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_png((folder / "missing.png").string()), InputError);
  std::ofstream(folder / "text.png") << "not a picture";
  EXPECT_THROW(read_png((folder / "text.png").string()), InputError);
  write_png(gradient(64, 64), (folder / "whole.png").string());
  std::filesystem::resize_file(folder / "whole.png", std::filesystem::file_size(folder / "whole.png") / 2);
  EXPECT_THROW(read_png((folder / "whole.png").string()), InputError);
}

}  // namespace
}  // namespace collidoscope
