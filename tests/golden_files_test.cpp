// Tests that every golden file is read by a test. A file that no test reads can be wrong without notice.

#include "tests/golden_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/test_files.h"

namespace collidoscope {
namespace {

TEST(GoldenFiles, EachIsReadByATest) {
  EXPECT_THAT(unread_files(project_file("tests/golden"), golden_files_read()), testing::IsEmpty())
      << "delete these files, or read them with golden_file<> or looks_like_golden<>";
}

TEST(GoldenFiles, EachThatATestReadsIsThere) {
  const std::filesystem::path goldens = project_file("tests/golden");
  for (const std::string& name : golden_files_read()) {
    if (!name.ends_with(".png")) {
      EXPECT_TRUE(std::filesystem::exists(goldens / name)) << name;
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(goldens))  // one folder per renderer
      EXPECT_TRUE(!entry.is_directory() || std::filesystem::exists(entry.path() / name))
          << entry.path() / name;
  }
}

TEST(GoldenFiles, AFileThatNoTestReadsIsFound) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "other renderer");
  for (const char* name : {"read.png", "read.json", "stray.png", "stray.json", "other renderer/read.png",
                           "other renderer/old.png"})
    std::ofstream(folder / name) << "x";
  EXPECT_THAT(unread_files(folder.path(), {"read.png", "read.json"}),
              testing::ElementsAre("other renderer/old.png", "stray.json", "stray.png"));
}

}  // namespace
}  // namespace collidoscope
