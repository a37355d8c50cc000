// Every golden file is read by a test: one that no test reads can be wrong for years.

#include "tests/golden_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/test_files.h"

namespace collidoscope {
namespace {

TEST(GoldenFiles, EachIsReadByATest) {
  EXPECT_THAT(unread_files(project_file("tests/golden"), golden_files_read()), testing::IsEmpty())
      << "delete these files, or read them with golden_file<> or check_golden<>";
}

TEST(GoldenFiles, EachThatATestReadsIsThere) {
  for (const std::string& name : golden_files_read())
    EXPECT_TRUE(std::filesystem::exists(project_file("tests/golden/" + name))) << name;
}

TEST(GoldenFiles, AFileThatNoTestReadsIsFound) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "other renderer");
  for (const char* name : {"read.png", "read.txt", "read.json", "stray.png", "stray.txt", "stray.json",
                           "other renderer/read.png", "other renderer/old.png"})
    std::ofstream(folder / name) << "x";
  EXPECT_THAT(unread_files(folder.path(), {"read.png", "read.json"}),
              testing::ElementsAre("other renderer/old.png", "stray.json", "stray.png", "stray.txt"));
}

}  // namespace
}  // namespace collidoscope
