// Tests every flag and operand that names an input file with files of a wrong kind. The program must print
// one clear line, exit with status 2 and write nothing. The tests run the real programs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "tests/random.h"
#include "tests/run_program.h"
#include "viewer/render/image.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

/// An invocation that reads a file: `@` stands for the bad file, `#` for a folder of valid files.
struct Reader {
  std::string name;
  std::vector<std::string> arguments;
  bool folder = false;  ///< the operand names a folder
};
void PrintTo(const Reader& reader, std::ostream* stream) { *stream << reader.name; }

struct BadFile {
  std::string name;
  std::function<void(const fs::path&)> make;
};

void write(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

std::string random_bytes() {
  Random random(1);
  std::string bytes;
  for (int k = 0; k < 4096; ++k) bytes += static_cast<char>(random() & 0xff);
  return bytes;
}

const std::vector<BadFile> bad_files{
    {"missing", [](const fs::path&) {}},
    {"empty", [](const fs::path& file) { write(file, ""); }},
    {"a folder", [](const fs::path& file) { fs::create_directory(file); }},
    {"words", [](const fs::path& file) { write(file, "what is this?\n"); }},
    {"an object", [](const fs::path& file) { write(file, "{}\n"); }},
    {"random bytes", [](const fs::path& file) { write(file, random_bytes()); }},
    {"a hole of a terabyte",
     [](const fs::path& file) {
       write(file, "");
       fs::resize_file(file, std::uintmax_t{1} << 40);
     }},
    {"locked", [](const fs::path& file) {
       write(file, "{}\n");
       fs::permissions(file, fs::perms::none);
     }}};

const std::vector<BadFile> bad_folders{{"missing", [](const fs::path&) {}},
                                       {"empty", [](const fs::path& file) { fs::create_directory(file); }},
                                       {"a file", [](const fs::path& file) { write(file, "{}\n"); }},
                                       {"locked", [](const fs::path& file) {
                                          fs::create_directory(file);
                                          fs::permissions(file, fs::perms::none);
                                        }}};

/// Names and sizes of all files below a folder.
std::map<std::string, std::uintmax_t> contents(const fs::path& folder) {
  std::map<std::string, std::uintmax_t> all;
  for (const auto& entry :
       fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied))
    all[entry.path().string()] = entry.is_regular_file() ? entry.file_size() : 0;
  return all;
}

std::vector<std::string> with(std::vector<std::string> arguments, const std::string& bad,
                              const std::string& good) {
  for (std::string& argument : arguments)
    for (const auto& [mark, text] : {std::pair('@', &bad), {'#', &good}})
      if (const std::size_t at = argument.find(mark); at != std::string::npos) argument.replace(at, 1, *text);
  return arguments;
}

std::int64_t lines_in(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

Outcome run_either(std::vector<std::string> arguments) {
  const Launch launch{.obey_permissions = true};
  if (arguments[0] != "collidoscope") return run_headless(arguments, launch);
  arguments.erase(arguments.begin());
  return run_viewer(arguments, launch);
}

class BadFiles : public testing::TestWithParam<Reader> {
 protected:
  BadFiles() {
    fs::create_directory(good_);
    Image picture{16, 16, std::vector<std::uint8_t>(16 * 16 * 4, 255)};
    write_png(picture, (good_ / "a.png").string());
    write(good_ / "readme.md", "# Nothing\n");
    write(
        good_ / "mesh.json",
        R"({"format": "collidoscope-scene", "version": 1, "bodies": [{"shape": "mesh", "mesh": "../bad"}]})");
  }

  void expect_refused(const std::string& what) {
    SCOPED_TRACE(what);
    const auto before = contents(folder_.path());
    const Outcome outcome = run_either(with(GetParam().arguments, bad_.string(), good_.string()));
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, testing::HasSubstr(bad_.filename().string())) << "no line names the file";
    EXPECT_GE(lines_in(outcome.err), 1);
    // A parsed file may have several faults, and the mesh reader checks each line.
    const bool read = what == "an object" || (what == "random bytes" && GetParam().name == "RunMesh");
    EXPECT_LE(lines_in(outcome.err), read ? 21 : 1) << outcome.err;
    fs::permissions(bad_, fs::perms::owner_all, fs::perm_options::add, ignored_);
    EXPECT_EQ(contents(folder_.path()), before);
  }

  TemporaryFolder folder_;
  fs::path bad_ = folder_ / "bad", good_ = folder_ / "good";
  std::error_code ignored_;
};

TEST_P(BadFiles, AreRefusedWithALine) {
  for (const BadFile& bad : GetParam().folder ? bad_folders : bad_files) {
    bad.make(bad_);
    expect_refused(bad.name);
    fs::remove_all(bad_);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, BadFiles,
    testing::Values(
        Reader{"RunScene", {"run", "@"}}, Reader{"RunLoad", {"run", "--load", "@"}},
        Reader{"RunChanges", {"run", "one_body", "--changes", "@"}},
        Reader{"RunMesh", {"run", "#/mesh.json"}}, Reader{"CaptureScene", {"capture", "@", "--out", "#/out"}},
        Reader{"CaptureLoad", {"capture", "--load", "@", "--out", "#/out"}}, Reader{"BvhScene", {"bvh", "@"}},
        Reader{"AccuracyScene", {"accuracy", "@"}}, Reader{"BenchScene", {"bench", "solvers", "@"}},
        Reader{"CompareFirst", {"compare", "@", "#/a.png"}},
        Reader{"CompareSecond", {"compare", "#/a.png", "@"}},
        Reader{"StabilityCases", {"stability", "--cases", "@"}, true},
        Reader{"StabilityFrom", {"stability", "--write-table", "#/readme.md", "--from", "@"}},
        Reader{"ViewerScene", {"collidoscope", "@"}}, Reader{"ViewerLoad", {"collidoscope", "--load", "@"}},
        Reader{"ViewerCases", {"collidoscope", "--cases", "@"}, true}),
    [](const auto& each) { return each.param.name; });

/// The README is bad and the other file is valid, so the fault is in the README.
TEST(BadReadme, IsRefusedWithALine) {
  const TemporaryFolder folder;
  const std::string results = folder / "results.json", readme = folder / "bad";
  write(results, R"({"suite": "stability", "cases": [], "trials": []})");
  for (const BadFile& bad : bad_files) {
    SCOPED_TRACE(bad.name);
    bad.make(readme);
    const Outcome outcome = run_headless({"stability", "--write-table", readme, "--from", results},
                                         Launch{.obey_permissions = true});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(lines_in(outcome.err), 1) << outcome.err;
    EXPECT_THAT(outcome.err, testing::StartsWith(readme + ": "));
    fs::remove_all(readme);
  }
}

/// A snapshot damaged at different places, read by each program.
class DamagedSnapshot : public testing::Test {
 protected:
  DamagedSnapshot() {
    EXPECT_EQ(run_headless({"run", "box_collider", "--bodies", "20", "--steps", "2", "--save", file_}).status,
              0);
    good_ = text_of(file_);
  }

  void expect_refused(const std::string& bytes) {
    write(file_, bytes);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"run", "--load", file_, "--steps", "0"},
          {"capture", "--load", file_, "--out", folder_ / "out"},
          {"collidoscope", "--load", file_}}) {
      const Outcome outcome = run_either(arguments);
      EXPECT_EQ(outcome.status, 2) << arguments[0] << ": " << outcome.err;
      EXPECT_EQ(lines_in(outcome.err), 1) << outcome.err;
      EXPECT_THAT(outcome.err, testing::StartsWith(file_ + ": is "));
      EXPECT_EQ(outcome.out, "");
    }
    EXPECT_EQ(folder_.files(), 1u);
  }

  TemporaryFolder folder_;
  std::string file_ = folder_ / "s", good_;
};

TEST_F(DamagedSnapshot, CutShortAtEachBlock) {
  // Layout: header, length of the scene text, scene text, settings, lists, hash.
  std::uint64_t scene_bytes = 0;
  std::memcpy(&scene_bytes, good_.data() + 40, 8);
  const std::size_t scene_end = 48 + (scene_bytes + 7) / 8 * 8;
  for (const std::size_t bytes :
       {std::size_t{24}, std::size_t{40}, std::size_t{48}, scene_end, scene_end + 8, scene_end + 40,
        scene_end + 48, (scene_end + good_.size()) / 16 * 8, good_.size() - 8, good_.size() - 1}) {
    SCOPED_TRACE(bytes);
    expect_refused(good_.substr(0, bytes));
  }
  expect_refused(good_ + std::string(8, '\0'));
}

TEST_F(DamagedSnapshot, FlippedAnywhere) {
  for (std::size_t at = 0; at < good_.size(); at += good_.size() / 8) {
    SCOPED_TRACE(at);
    std::string bytes = good_;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x20);
    expect_refused(bytes);
  }
}

TEST_F(DamagedSnapshot, LongerByAHole) {
  write(file_, good_);
  fs::resize_file(file_, std::uintmax_t{1} << 40);
  const Outcome outcome = run_headless({"run", "--load", file_});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, testing::StartsWith(file_ + ": is damaged: it has 1099511627776 of "));
}

/// A picture header that announces more pixels than the file holds must not cause a large allocation.
TEST(DamagedPicture, OfGreatSizeIsRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "a.png";
  write_png(Image{16, 16, std::vector<std::uint8_t>(16 * 16 * 4, 255)}, file);
  const std::string good = text_of(file);
  // Width and height are at offset 16. The checksum follows the 13 data bytes of the chunk, which begins at
  // 12.
  std::string huge = good;
  for (const std::size_t at : {16u, 20u}) huge.replace(at, 4, std::string("\0\0\x7f\xff", 4));
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t k = 12; k < 29; ++k) {
    crc ^= static_cast<unsigned char>(huge[k]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  for (std::size_t k = 0; k < 4; ++k) huge[29 + k] = static_cast<char>(~crc >> (24 - 8 * k));
  write(file, huge);
  const Outcome outcome = run_headless({"compare", file, file});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(
      outcome.err,
      file + ": is damaged: the file is too short for 32767x32767 pixels; expected a complete PNG image\n");
  // Only the last chunk, 12 bytes, may be missing from a complete picture.
  for (std::size_t bytes = 0; bytes + 16 < good.size(); bytes += good.size() / 12) {
    write(file, good.substr(0, bytes));
    const Outcome cut = run_headless({"compare", file, file});
    EXPECT_EQ(cut.status, 2) << bytes;
    EXPECT_EQ(lines_in(cut.err), 1) << cut.err;
  }
}

}  // namespace
}  // namespace collidoscope
