// Tests the script `dev` without a display: the arguments that it passes to the headless program. The build
// is replaced by programs that do nothing, and the headless program by one that prints its arguments.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/run_program.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

void write_script(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << "#!/bin/sh\n" << text << '\n';
  fs::permissions(file, fs::perms::owner_all);
}

class DevRun : public testing::Test {
 protected:
  DevRun() {
    fs::copy_file(project_file("dev"), folder_ / "dev");
    write_script(folder_ / "stubs/cmake", "exit 0");
    write_script(folder_ / "stubs/dpkg-query", "echo installed");
    write_script(folder_ / "build/release/bin/collidoscope-headless", "echo \"$@\"");
    path_ = std::getenv("PATH");
    setenv("PATH", ((folder_ / "stubs").string() + ":" + path_).c_str(), 1);
    setenv("COLLIDOSCOPE_PRESET", "release", 1);
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
  }
  ~DevRun() override {
    setenv("PATH", path_.c_str(), 1);
    unsetenv("COLLIDOSCOPE_PRESET");
  }

  std::string handed(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {folder_ / "dev", "run"});
    const Outcome outcome = run_program("/bin/bash", arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  }

  TemporaryFolder folder_;
  std::string path_;
};

TEST_F(DevRun, WithoutASceneIsTheBoxCollider) {
  EXPECT_EQ(handed({}), "capture box_collider --layers spheres,bvh:2-5,contacts\n");
  EXPECT_EQ(handed({"--bodies", "10"}),
            "capture box_collider --layers spheres,bvh:2-5,contacts --bodies 10\n");
}

TEST_F(DevRun, NamesOneScene) {
  EXPECT_EQ(handed({"gas", "--layers", "spheres"}), "capture gas --layers spheres\n");
}

TEST_F(DevRun, OfASnapshotNamesNoScene) {
  EXPECT_EQ(handed({"--load", "s"}), "capture --layers spheres,bvh:2-5,contacts --load s\n");
  EXPECT_EQ(handed({"--load=s"}), "capture --layers spheres,bvh:2-5,contacts --load=s\n");
}

}  // namespace
}  // namespace collidoscope
