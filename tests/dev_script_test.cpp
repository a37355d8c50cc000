// Tests the script `dev` without a display: the arguments that it passes to the headless program. The build
// is replaced by programs that do nothing, and the headless program by one that prints its arguments.
// Also tests how `gpu-check bench` compares hashes, with a headless program that writes a fixed report.

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

/// Runs `gpu-check bench` with the same committed report for each of its runs, and a program that writes
/// `now`.
Outcome gpu_check(const std::string& committed, const std::string& now) {
  const TemporaryFolder folder;
  const fs::path script = project_file(".ci/gpu-check"), results = project_file("assets/results/nvidia-h100"),
                 copies = folder / "assets/results/nvidia-h100";
  // A bundle has the script in its root.
  fs::copy_file(fs::exists(script) ? script : project_file("gpu-check"), folder / "gpu-check");
  fs::create_directories(copies);
  fs::create_directories(folder / "assets/scenes");
  fs::copy_file(project_file("assets/scenes/box_collider.json"), folder / "assets/scenes/box_collider.json");
  for (const auto& entry : fs::directory_iterator(results))
    if (entry.path().extension() == ".json") std::ofstream(copies / entry.path().filename()) << committed;
  std::ofstream(folder / "now.json") << now;
  write_script(folder / "bin/collidoscope-headless", "while [ \"$1\" != --json ]; do shift; done; cp '" +
                                                         (folder / "now.json").string() + "' \"$2\"");
  return run_program("/usr/bin/env", {"-u", "LOGS", "bash", folder / "gpu-check", "bench"});
}

TEST(GpuCheck, ComparesHashesOfOnePhysicsVersion) {
  const std::string times = "\"step_median_ms\": 2.0\n}\n",
                    hash = "{\n  \"state_hash\": \"000000000000000a\",\n  ",
                    other = "{\n  \"state_hash\": \"000000000000000b\",\n  ";
  const auto version = [](int number) { return "\"physics_version\": " + std::to_string(number) + ",\n  "; };
  const Outcome same = gpu_check(hash + version(2) + times, hash + version(2) + times);
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_THAT(same.out, testing::HasSubstr("ratio 1.000, hash same\n"));
  EXPECT_THAT(same.out, testing::HasSubstr("passed: "));
  const Outcome differs = gpu_check(hash + version(2) + times, other + version(2) + times);
  EXPECT_EQ(differs.status, 1);
  EXPECT_THAT(differs.out, testing::HasSubstr("ratio 1.000, hash DIFFERS\n"));
  // A committed file without the number has version 1.
  const Outcome old = gpu_check(hash + times, other + version(2) + times);
  EXPECT_EQ(old.status, 0) << old.out;
  EXPECT_THAT(old.out, testing::HasSubstr("ratio 1.000, cannot compare hashes: physics version 1\n"));
  EXPECT_EQ(gpu_check(hash + times, other + version(1) + times).status, 1);
}

}  // namespace
}  // namespace collidoscope
