// Tests the memory that a reader uses for an input file: files beyond each limit, and the worst files within
// the limits.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <fstream>
#include <functional>
#include <thread>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/json_document.h"
#include "sim_cuda/scene/mesh.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/memory/counted_new.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

constexpr std::int64_t mebibyte = std::int64_t{1} << 20;

struct Reading {
  std::string line;  ///< the first line of the refusal, or empty
  std::int64_t peak_bytes = 0;
};

/// Calls `read`; returns its message and its peak memory.
Reading tried(const std::function<void()>& read) {
  Reading reading;
  const std::int64_t before = counted_new().live_bytes;
  forget_peak();
  try {
    read();
  } catch (const InputError& error) {
    reading.line = error.lines().front();
  }
  reading.peak_bytes = counted_new().peak_bytes - before;
  return reading;
}

std::string repeated(const std::string& begin, const std::string& piece, std::size_t bytes,
                     const std::string& end) {
  std::string text = begin;
  text.reserve(bytes + piece.size() + end.size());
  while (text.size() < bytes) text += piece;
  text.pop_back();  // removes a trailing comma or newline
  return text + end;
}

class BoundedReading : public testing::Test {
 protected:
  std::string written(const std::string& text) {
    const std::string file = folder_ / "file";
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  TemporaryFolder folder_;
};

struct Reader {
  const char* name;
  void (*read)(const std::string& file);
};
const Reader readers[] = {
    {"scene", [](const std::string& file) { read_scene(file); }},
    {"changes", [](const std::string& file) { read_changes(file, Scene{}, {}, 0); }},
    {"mesh", [](const std::string& file) { read_mesh(file, "mesh"); }},
    {"snapshot", [](const std::string& file) { read_snapshot(file); }},
};

TEST_F(BoundedReading, AHundredMillionBytesAreRefusedUnread) {
  const std::string file = written("{");
  std::filesystem::resize_file(file, 100'000'000);
  for (const Reader& reader : readers) {
    const Reading reading = tried([&] { reader.read(file); });
    EXPECT_THAT(reading.line, testing::StartsWith(file + ": ")) << reader.name;
    EXPECT_LT(reading.peak_bytes, mebibyte) << reader.name;
  }
  EXPECT_THAT(tried([&] { read_scene(file); }).line, HasSubstr("larger than 64 MiB, the maximum size"));
}

TEST_F(BoundedReading, AHundredThousandListsWithinEachOtherAreRefused) {
  for (const std::string opening : {"[", "{\"a\":", "[{\"bodies\":"}) {
    std::string text;
    for (int depth = 0; depth < 100'000; ++depth) text += opening;
    const std::string file = written(text);
    for (const Reader& reader : readers) {
      const Reading reading = tried([&] { reader.read(file); });
      EXPECT_LT(reading.peak_bytes, static_cast<std::int64_t>(3 * text.size()) + mebibyte) << reader.name;
    }
    EXPECT_THAT(tried([&] { read_scene(file); }).line, HasSubstr("more than 64 nested arrays and objects"));
  }
}

TEST_F(BoundedReading, WhatNeverEndsIsReadAsFarAsTheLimit) {
  for (const Reader& reader : readers) {
    const Reading reading = tried([&] { reader.read("/dev/zero"); });
    EXPECT_THAT(reading.line, testing::StartsWith("/dev/zero: ")) << reader.name;
    EXPECT_LT(reading.peak_bytes, 2 * static_cast<std::int64_t>(JsonDocument::max_bytes) + mebibyte)
        << reader.name;
  }
}

TEST_F(BoundedReading, OfFoldersAndPipes) {
  const std::string pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const Reader& reader : readers) {
    EXPECT_THAT(tried([&] { reader.read(folder_.path()); }).line, HasSubstr(": is a folder")) << reader.name;
    if (std::string(reader.name) == "snapshot") continue;
    // A pipe from another program: collidoscope-headless run <(...)
    std::thread writer([&] { std::ofstream(pipe) << "v 0 0\n"; });
    EXPECT_THAT(tried([&] { reader.read(pipe); }).line, testing::StartsWith(pipe + ":1:1: ")) << reader.name;
    writer.join();
  }
  EXPECT_EQ(tried([&] { read_snapshot(pipe); }).line,
            pipe + ": is a pipe; expected a regular file, because a snapshot is read twice");
}

/// Two snapshots of equal size alternate in one file that is rewritten in place.
TEST_F(BoundedReading, ASnapshotThatChangesWhileItIsReadIsNoMixture) {
  Snapshot snapshot;
  snapshot.scene.bodies.resize(20'000);
  snapshot.state.bodies.position.resize(20'000, Vector3d(1, 1, 1));
  snapshot.state.bodies.velocity = snapshot.state.bodies.angular_velocity = snapshot.state.bodies.position;
  snapshot.state.bodies.orientation.resize(20'000, Quaterniond(1, 0, 0, 0));
  std::string turns[2];
  for (std::string& bytes : turns) {
    write_snapshot(snapshot, [&](std::string_view more) { bytes += more; });
    snapshot.state.bodies.position.assign(20'000, Vector3d(2, 2, 2));
  }
  const std::string file = written(turns[0]);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    const int out = open(file.c_str(), O_WRONLY | O_CLOEXEC);
    for (int turn = 0; !done; turn = 1 - turn)
      if (pwrite(out, turns[turn].data(), turns[turn].size(), 0) < 0) break;
    close(out);
  });
  for (int k = 0; k < 20; ++k) {
    Snapshot read;
    const Reading reading = tried([&] { read = read_snapshot(file); });
    if (!reading.line.empty()) continue;
    for (const Vector3d& position : read.state.bodies.position)
      ASSERT_EQ(position, read.state.bodies.position.front());
  }
  done = true;
  writer.join();
}

/// The address sanitizer needs five times as long, so the files are smaller with it.
#ifdef WITH_SANITIZER
constexpr std::size_t part = 16;
#else
constexpr std::size_t part = 1;
#endif

TEST_F(BoundedReading, AFullSceneOfAHundredThousandBodies) {
  std::string text =
      R"({"format": "collidoscope-scene", "version": 1, "materials": {"steel": {"density": 7800}},
    "bodies": [)";
  constexpr int bodies = 100'000 / part;
  for (int i = 0; i < bodies; ++i)
    text += fmt::format(
        "{}\n  {{\"shape\": \"sphere\", \"radius\": 0.5, \"position\": [{}.25, {}.5, 0.125], "
        "\"orientation\": [1, 0, 0, 0], "
        "\"velocity\": [1.5, -2.25, 3], \"angular_velocity\": [0.5, 0, 0], \"mass\": 12.5, "
        "\"inertia\": [1.25, 1.25, 1.25], \"material\": \"steel\"}}",
        i > 0 ? "," : "", 2 * (i % 300), 2 * (i / 300));
  text += "]}";
  const std::string file = written(text);
  Scene scene;
  const Reading reading = tried([&] { scene = read_scene(file); });
  EXPECT_EQ(reading.line, "");
  EXPECT_EQ(scene.bodies.size(), static_cast<std::size_t>(bodies));
  const double per_byte = static_cast<double>(reading.peak_bytes) / static_cast<double>(text.size());
  RecordProperty("bytes_of_memory_per_byte_of_text", fmt::format("{:.2f}", per_byte));
  EXPECT_LT(per_byte, 12);
}

/// Files of the maximum size, with the content that needs the most memory.
TEST_F(BoundedReading, TheWorstFilesTakeNoMoreThanAGibibyte) {
  const std::string head = R"({"format": "collidoscope-scene", "version": 1, )";
  const std::pair<const char*, std::string> files[] = {
      {"values", repeated("[", "0,", JsonDocument::max_bytes / part - 1, "]")},
      {"bodies", repeated(head + "\"bodies\": [", "{},", (std::size_t{3} << 20) / part, "]}")},
      {"joints", repeated(head + "\"joints\": [", "{},", (std::size_t{3} << 20) / part, "]}")},
      {"too many bodies", repeated(head + "\"bodies\": [", "{},", (std::size_t{20} << 20) / part, "]}")},
      {"materials", repeated(head + "\"materials\": {", "\"\":{},", (std::size_t{20} << 20) / part, "}}")},
      {"unknown keys", repeated(head, "\"k\":0,", (std::size_t{20} << 20) / part, "}")},
      {"escapes", repeated("[", "\"\\n\",", (std::size_t{20} << 20) / part, "]")},
  };
  for (const auto& [name, text] : files) {
    const std::string file = written(text);
    const Reading reading = tried([&] { read_scene(file); });
    EXPECT_LT(reading.peak_bytes, 1024 * mebibyte) << name;
    std::printf("%-16s %5lld MiB of memory for %2lld MiB of text: %s\n", name,
                static_cast<long long>(reading.peak_bytes / mebibyte),
                static_cast<long long>(text.size()) / mebibyte,
                reading.line.empty() ? "read" : reading.line.substr(file.size(), 100).c_str());
  }
}

TEST_F(BoundedReading, TheWorstMeshesTakeTwentyTimesTheirSize) {
  constexpr std::size_t bytes = std::size_t{8} << 20;
  const std::pair<const char*, std::string> files[] = {
      {"vertices", repeated("", "v 1 1 1\n", bytes, "\n")},
      {"open faces", repeated("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n", bytes, "\n")},
      {"missing vertices", repeated("", "f 1 2 3\n", bytes, "\n")},
      {"faults", repeated("", "x\n", bytes, "\n")},
  };
  for (const auto& [name, text] : files) {
    const std::string file = written(text);
    const Reading reading = tried([&] { read_mesh(file, "mesh"); });
    EXPECT_LT(reading.peak_bytes, static_cast<std::int64_t>(20 * text.size())) << name;
    EXPECT_THAT(reading.line, testing::StartsWith(file)) << name;
  }
}

/// An earlier version compared each corner with all before it.
TEST_F(BoundedReading, OneFaceOfAMillionCorners) {
  std::string text = "f";
  for (int i = 1; i <= 1'000'000; ++i) text += fmt::format(" {}", i);
  EXPECT_THAT(tried([&] { parse_mesh(text + "\n", "f", "mesh"); }).line,
              HasSubstr("the face uses vertex 1, but"));
  EXPECT_THAT(tried([&] { parse_mesh(text + " 77\n", "f", "mesh"); }).line,
              HasSubstr("vertex 77 appears twice in one face"));
}

TEST_F(BoundedReading, ChangesThatRemoveAMillionBodies) {
  std::string text =
      R"({"format": "collidoscope-changes", "version": 1, "changes": [{"step": 1, "remove": [)";
  for (int i = 0; i < 1'000'000; ++i) text += fmt::format("{},", i);
  const Reading reading = tried([&] { parse_changes(text + "0]}]}", "f", Scene{}, {}, 0); });
  EXPECT_THAT(reading.line, HasSubstr("body 0 does not exist; ids must be below 0"));
  EXPECT_LT(reading.peak_bytes, 512 * mebibyte);
}

}  // namespace
}  // namespace collidoscope
