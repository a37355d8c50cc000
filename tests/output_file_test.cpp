// Tests OutputFile: a target appears complete at commit(), and errors are reported before or instead of it.
#include "headless/cli/output_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "sim_cuda/core/error.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

TEST(OutputFile, AppearsWholeAtCommit) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x") << "old";
  OutputFile file("--x", folder / "x");
  EXPECT_EQ(folder.files(), 1u);  // the writability check leaves no file
  file.write("new ");
  file.write("text");
  EXPECT_EQ(text_of(folder / "x"), "old");
  file.commit();
  EXPECT_EQ(text_of(folder / "x"), "new text");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(OutputFile, LeavesNothingWhereItWasNotCommitted) {
  const TemporaryFolder folder;
  {
    OutputFile file("--x", folder / "x");
    file.write("half");
  }
  EXPECT_EQ(folder.files(), 0u);
}

TEST(OutputFile, RefusesBeforeAnythingIsWritten) {
  const TemporaryFolder folder;
  for (const std::string& bad :
       {(folder / "none/x").string(), folder.path().string(), std::string("/proc/x")})
    EXPECT_THROW(OutputFile("--x", bad), InputError) << bad;
}

TEST(OutputFile, AFullDiskIsReported) {
  OutputFile file("--x", "/dev/full");
  EXPECT_THROW(
      {
        file.write("text");
        file.commit();
      },
      MachineError);
}

TEST(OutputFile, AnEmptyFileIsAFile) {
  const TemporaryFolder folder;
  OutputFile("--x", folder / "x").commit();
  EXPECT_TRUE(fs::exists(folder / "x"));
}

}  // namespace
}  // namespace collidoscope
