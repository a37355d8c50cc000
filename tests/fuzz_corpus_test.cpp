// Tests the readers with the corpora of the fuzzers in tests/fuzz, by the same checks. Needs no clang.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sim_cuda/core/error.h"
#include "tests/fuzz/reader_checks.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

struct Corpus {
  const char* reader;
  void (*check)(const std::string&);
};

class FuzzCorpus : public testing::TestWithParam<Corpus> {};

TEST_P(FuzzCorpus, HoldsNothingThatAReaderStumblesOver) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(
           project_file(std::string("tests/fuzz/corpus/") + GetParam().reader)))
    files.push_back(entry.path());
  std::ranges::sort(files);
  EXPECT_GT(files.size(), 5u);
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file);
    EXPECT_NO_THROW(GetParam().check(text_of(file)));
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzCorpus,
                         testing::Values(Corpus{"scene", check_scene}, Corpus{"changes", check_changes},
                                         Corpus{"criterion", check_criterion},
                                         Corpus{"snapshot", check_snapshot},
                                         Corpus{"recording", check_recording}, Corpus{"object", check_object},
                                         Corpus{"npy", check_npy}, Corpus{"tree", check_tree},
                                         Corpus{"table", check_table}, Corpus{"robot", check_robot}),
                         [](const auto& each) { return each.param.reader; });

/// Reads every scene of the project with few bodies, with the checks of the fuzzers.
TEST(FuzzCorpus, ScenesOfTheProject) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(project_file("assets/scenes"))) {
    SCOPED_TRACE(entry.path());
    if (entry.path().extension() == ".obj") {
      EXPECT_NO_THROW(check_object(text_of(entry.path())));
    } else if (entry.path().extension() == ".json") {
      EXPECT_NO_THROW(check_scene(text_of(entry.path())));
    }
  }
}

/// The checks can fail: for a reader that accepts invalid input, or refuses it by another exception.
TEST(FuzzChecks, TellWhatIsWrong) {
  EXPECT_NO_THROW(check_changes(R"({"format": "collidoscope-changes", "version": 1, "changes": []})"));
  EXPECT_NO_THROW(check_scene(changed_scene()));
  EXPECT_THROW(reads("a file", [] { throw InputError("another: is bad"); }), std::logic_error);
  EXPECT_THROW(reads("a file", [] { throw InputError("a file: two\nlines"); }), std::logic_error);
  EXPECT_FALSE(reads("a file", [] { throw InputError("a file:1:2: is bad"); }));
  EXPECT_TRUE(reads("a file", [] {}));
}

}  // namespace
}  // namespace collidoscope
