// Tests that an output file is either the old one or the complete new one, also when the writer is killed at
// any moment.
#include "sim_cuda/core/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>

#include "tests/random.h"
#include "tests/run_program.h"
#include "viewer/render/image.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

TEST(AtomicFile, IsAsItWasUntilCommit) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x") << "old";
  {
    AtomicFile given_up(folder / "x");
    given_up.write("half");
  }
  EXPECT_EQ(folder.files(), 1u);
  AtomicFile file(folder / "x");
  file.write("new ");
  file.write("text");
  EXPECT_EQ(text_of(folder / "x"), "old");
  file.commit();
  EXPECT_EQ(text_of(folder / "x"), "new text");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(AtomicFile, TwoWritersOfOneTargetDoNotMeet) {
  const TemporaryFolder folder;
  AtomicFile first(folder / "x"), second(folder / "x");
  first.write("first");
  second.write("second");
  second.commit();
  EXPECT_EQ(text_of(folder / "x"), "second");
  AtomicFile third(folder / "x");
  first.commit();
  EXPECT_EQ(text_of(folder / "x"), "first");
  third.write("third");
  third.commit();
  EXPECT_EQ(text_of(folder / "x"), "third");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(AtomicFile, ALinkStaysOne) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x") << "old";
  fs::create_symlink("x", folder / "link");
  write_file_atomically(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(text_of(folder / "x"), "new");
}

TEST(AtomicFile, ALinkToNothingYetStaysOne) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "sub");
  fs::create_symlink("sub/second", folder / "link");
  fs::create_symlink("x", folder / "sub/second");
  write_file_atomically(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_TRUE(fs::is_symlink(folder / "sub/second"));
  EXPECT_EQ(text_of(folder / "sub/x"), "new");

  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  const Outcome outcome = run_headless({"run", "one_body", "--steps", "1", "--json", folder / "a"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("cannot be written: Too many levels of symbolic links"));
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
}

TEST(AtomicFile, ANewOneReplacesNone) {
  const TemporaryFolder folder;
  std::ofstream(folder / "x") << "old";
  AtomicFile file(folder / "x");
  file.write("new");
  EXPECT_FALSE(file.commit_new(folder / "x"));
  EXPECT_EQ(text_of(folder / "x"), "old");
  EXPECT_TRUE(file.commit_new(folder / "y"));
  EXPECT_EQ(text_of(folder / "y"), "new");
  EXPECT_EQ(folder.files(), 2u);
}

TEST(AtomicFile, WhatCannotBeWrittenIsSaidWithItsName) {
  const TemporaryFolder folder;
  const auto line = [](const std::string& file) -> std::string {
    try {
      AtomicFile whole(file);
      whole.write("text");
      whole.commit();
    } catch (const FileWriteError& error) {
      return error.what();
    }
    return "written";
  };
  EXPECT_EQ(line("/dev/full"), "/dev/full cannot be written: No space left on device");
  EXPECT_EQ(line("/dev/null"), "written");
  EXPECT_EQ(line("/proc/x"), "/proc/x cannot be written: No such file or directory");
  EXPECT_THAT(line(folder.path()), testing::HasSubstr("Is a directory"));
}

/// Runs `write` in a child process and kills it at a random time within its usual duration.
void kill_while(const std::function<void()>& write, Uniform& uniform) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    write();
    _exit(0);
  }
  usleep(static_cast<useconds_t>(uniform(0, 20'000)));
  kill(child, SIGKILL);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
}

TEST(AtomicFile, IsOldOrNewWheneverItsWriterIsKilled) {
  const TemporaryFolder folder;
  const std::string text = folder / "text", picture = folder / "picture.png";
  const std::string texts[2] = {std::string(3 << 20, 'a'), std::string(2 << 20, 'b')};
  Image images[2] = {{300, 200, std::vector<std::uint8_t>(300 * 200 * 4, 255)},
                     {200, 300, std::vector<std::uint8_t>(300 * 200 * 4, 255)}};
  for (std::size_t k = 0; k < images[1].rgba.size(); ++k)
    if (k % 4 != 3) images[1].rgba[k] = static_cast<std::uint8_t>(k * k / 7);
  const auto write_all_the_time = [&] {
    for (int turn = 0;; turn = 1 - turn) {
      write_file_atomically(text, texts[turn]);
      write_png(images[turn], picture);
    }
  };
  write_file_atomically(text, texts[0]);
  write_png(images[0], picture);
  Uniform uniform{Random(1)};
  std::size_t left = 0;
  for (int k = 0; k < 60; ++k) {
    ASSERT_NO_FATAL_FAILURE(kill_while(write_all_the_time, uniform));
    const std::string now = text_of(text);
    ASSERT_TRUE(now == texts[0] || now == texts[1]) << "after " << k << " kills";
    const Image drawn = read_png(picture);
    ASSERT_TRUE(drawn == images[0] || drawn == images[1]) << "after " << k << " kills";
    left = std::max(left, folder.files() - 2);
  }
  EXPECT_GT(left, 0u) << "no kill came while a file was being written";
  EXPECT_LE(left, 2u) << "what killed writers leave piles up";
  write_file_atomically(text, "whole");
  write_png(images[0], picture);
  EXPECT_EQ(folder.files(), 2u);
}

/// The program overwrites the files of a run that was one step longer.
TEST(AtomicFile, IsOldOrNewWheneverTheProgramIsKilled) {
  const TemporaryFolder folder;
  const std::vector<std::string> names{"json", "bodies", "dynamics", "energy", "snapshot"};
  const auto arguments = [&](const std::string& steps, const std::string& prefix) {
    std::vector<std::string> flags{"run",      "box_collider", "--executor", "cpu",
                                   "--bodies", "3000",         "--steps",    steps};
    const char* const of_flag[] = {"--json", "--dump-bodies", "--dump-dynamics", "--energy-trace", "--save"};
    for (std::size_t k = 0; k < names.size(); ++k)
      flags.insert(flags.end(), {of_flag[k], (folder / (prefix + names[k])).string()});
    return flags;
  };
  for (const std::string steps : {"1", "2"})
    ASSERT_EQ(run_headless(arguments(steps, "of" + steps)).status, 0);
  ASSERT_EQ(run_headless(arguments("1", "")).status, 0);
  const std::size_t files = folder.files();
  // The report contains times, which differ between runs. Its last characters show that it is complete.
  const auto is_whole = [&](const std::string& name) {
    const std::string now = text_of(folder / name);
    if (name == "json") return now.starts_with("{") && now.ends_with("}\n");
    return now == text_of(folder / ("of1" + name)) || now == text_of(folder / ("of2" + name));
  };
  Uniform uniform{Random(2)};
  int killed = 0;
  for (int k = 0; k < 40; ++k) {
    const std::vector<std::string> flags = arguments(k % 2 == 0 ? "2" : "1", "");
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      std::vector<char*> argv{const_cast<char*>("collidoscope-headless")};
      for (const std::string& flag : flags) argv.push_back(const_cast<char*>(flag.c_str()));
      argv.push_back(nullptr);
      if (std::freopen("/dev/null", "w", stdout) != nullptr &&
          std::freopen("/dev/null", "w", stderr) != nullptr)
        execv((program_folder() / "collidoscope-headless").c_str(), argv.data());
      _exit(127);
    }
    // Waits until the program starts to write, or has ended.
    int status = 0;
    const auto writes = [&] { return folder.files() > files; };
    pid_t done = 0;
    const bool left_before = writes();
    while (done == 0 && (left_before || !writes())) {
      usleep(100);
      done = waitpid(child, &status, WNOHANG);
      if (left_before && uniform(0, 1) < 0.002) break;
    }
    if (done == 0) {
      usleep(static_cast<useconds_t>(uniform(0, 15'000)));
      killed += kill(child, SIGKILL) == 0;
      ASSERT_EQ(waitpid(child, &status, 0), child);
    }
    for (const std::string& name : names) ASSERT_TRUE(is_whole(name)) << name << " after " << k << " kills";
    ASSERT_LE(folder.files(), files + names.size()) << "what killed programs leave piles up";
  }
  EXPECT_GT(killed, 0);
  EXPECT_EQ(run_headless(arguments("1", "")).status, 0);
  EXPECT_EQ(folder.files(), files);
}

TEST(AtomicFile, AFolderThatCannotBeMadeIsNamed) {
  const TemporaryFolder folder;
  make_folder(folder / "a/b");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b"));
  make_folder(folder / "a/b");
  write_file_atomically(folder / "file", "in the way");
  const std::string file = folder / "file";
  const auto words = [](auto act) -> std::string {
    try {
      act();
    } catch (const MachineError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(words([&] { make_folder(file); }),
            "Cannot create folder " + file + ": a file with this name exists");
  EXPECT_EQ(
      words([&] { write_file_atomically(file + "/x.json", "text"); }),
      file + "/x.json cannot be written: cannot create folder " + file + ": a file with this name exists");
}

}  // namespace
}  // namespace collidoscope
