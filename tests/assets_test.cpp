// Tests the search for the assets folder: its order, and the error message that lists every searched place.
#include "sim_cuda/core/assets.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "sim_cuda/core/error.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

class AssetsFrom {  // sets the variable for one scope
 public:
  explicit AssetsFrom(const std::filesystem::path& folder) {
    if (const char* before = std::getenv("COLLIDOSCOPE_ASSETS")) before_ = before;
    setenv("COLLIDOSCOPE_ASSETS", folder.c_str(), 1);
  }
  ~AssetsFrom() {
    if (before_.empty())
      unsetenv("COLLIDOSCOPE_ASSETS");
    else
      setenv("COLLIDOSCOPE_ASSETS", before_.c_str(), 1);
  }

 private:
  std::string before_;
};

TEST(Assets, TheNamedFolderComesFirst) {
  const TemporaryFolder folder;
  std::ofstream(folder / "only_here.txt") << "x";
  const AssetsFrom named(folder.path());
  EXPECT_EQ(asset("only_here.txt"), folder / "only_here.txt");
}

TEST(Assets, AFolderThatLacksTheFileIsPassedOver) {
  const auto scenes = asset("scenes");
  const TemporaryFolder empty;
  const AssetsFrom named(empty.path());
  // The search continues in the folders beside the program. A build tree outside the sources has none there.
  try {
    EXPECT_TRUE(std::filesystem::equivalent(asset("scenes"), scenes));
  } catch (const MachineError& error) {
    EXPECT_NE(std::string(error.what()).find(empty.path().string()), std::string::npos);
  }
}

TEST(Assets, WhatIsMissingIsNamedWithEveryPlaceSearched) {
  try {
    asset("no/such/file");
    FAIL() << "found a file that does not exist";
  } catch (const MachineError& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find("'no/such/file'"), std::string::npos);
    EXPECT_NE(line.find((program_folder().parent_path() / "assets").string()), std::string::npos);
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace collidoscope
