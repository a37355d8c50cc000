// Golden files: where they are, when they are written, and what is said if a picture differs.

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include <collidoscope/capture.h>
#include "capture/page.h"
#include "capture/words.h"

namespace collidoscope::capture {
namespace {

namespace fs = std::filesystem;

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != 0 && std::string(value) != "0" && std::string(value) != "false";
}

std::string current_test() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  return test == nullptr ? "" : words(test->test_suite_name(), ".", test->name());
}

/// The command of the settings for the current test, whose name is escaped as a regular expression.
std::string command_that_accepts() {
  std::string test;
  for (const char c : current_test()) test += c == '.' ? "[.]" : std::string(1, c);
  std::string command = settings().command;
  if (const std::size_t at = command.find("{}"); at != std::string::npos) command.replace(at, 2, test);
  return command;
}

fs::path results_folder() {
  if (!settings().results.empty()) return settings().results;
  if (const char* folder = std::getenv("PICTURE_RESULTS"); folder != nullptr && *folder != 0) return folder;
  return fs::temp_directory_path() / "picture-results";
}

struct Golden {
  fs::path file;
  bool same_renderer = true;
};

/// The golden to compare with. It may be missing.
Golden find_golden(const std::string& name, Tier tier) {
  const fs::path& all = settings().goldens;
  const std::string file = name + ".png", folder = folder_of_renderer(settings().renderer);
  if (tier == Tier::exact) return {all / file};
  std::error_code failed;
  if (fs::is_directory(all / folder, failed)) return {all / folder / file};
  // Of another renderer, preferably of one with the same last part, such as the version of a library.
  const std::string last = folder.substr(std::min(folder.rfind('_'), folder.size()));
  std::vector<fs::path> others, alike;
  for (const fs::directory_entry& other : fs::directory_iterator(all, failed))
    if (fs::exists(other.path() / file)) {
      others.push_back(other.path() / file);
      if (other.path().string().ends_with(last)) alike.push_back(other.path() / file);
    }
  if (others.empty()) return {all / folder / file};
  const std::vector<fs::path>& chosen = alike.empty() ? others : alike;
  return {*std::min_element(chosen.begin(), chosen.end()), false};
}

void record(const std::string& name, const char* quantity, const std::string& value) {
  testing::Test::RecordProperty("picture." + name + "." + quantity, value);
}

/// Empty if the test notices a change as small as it must.
std::string sensitivity_fault(const std::string& name, const Pixels& pixels, const Tolerance& tolerance) {
  if (tolerance.must_detect == 0 && !is_set("PICTURE_SENSITIVITY")) return "";
  const int side = smallest_detected_block(pixels, tolerance);
  record(name, "smallest_detected_block", words(side));
  if (is_set("PICTURE_SENSITIVITY"))
    std::fprintf(stderr, "%s: the smallest block that is noticed has %d x %d pixels\n", name.c_str(), side,
                 side);
  if (tolerance.must_detect == 0 || side <= tolerance.must_detect) return "";
  return words("the test would not notice a block of ", tolerance.must_detect, " x ", tolerance.must_detect,
               " pixels of another colour; the smallest that it notices has ", side, " x ", side,
               ": use a smaller tolerance");
}

std::string update(const std::string& name, const Pixels& pixels, const fs::path& file, bool passes) {
  if (is_set("CI")) return "UPDATE_GOLDENS: refused, because CI is set: golden files are changed by people";
  if (passes) return "";  // has not changed
  write_png(pixels, file);
  std::fprintf(stderr, "%s: wrote %s\n", name.c_str(), file.c_str());
  return "";
}

testing::AssertionResult failure(FailedPicture failed, const std::string& name) {
  failed.test = current_test();
  failed.name = name;
  failed.command = command_that_accepts();
  const fs::path page = add_to_page(results_folder(), failed);
  return testing::AssertionFailure() << name << ": " << failed.text
                                     << "; to accept the picture: " << failed.command << "; see "
                                     << page.string();
}

testing::AssertionResult check(const std::string& name, const Pixels& pixels, Tolerance tolerance) {
  const Golden golden = find_golden(name, tolerance.tier);
  const fs::path file = golden.same_renderer
                            ? golden.file
                            : settings().goldens / folder_of_renderer(settings().renderer) / (name + ".png");
  std::error_code failed;
  const bool exists = fs::exists(golden.file, failed);
  Picture expected;
  if (exists) expected = read_png(golden.file);
  if (!golden.same_renderer && tolerance.tier == Tier::tight) {
    const std::vector<Region> ignored = tolerance.ignored;
    tolerance = loose();
    tolerance.ignored = ignored;
  }
  Comparison result;
  if (exists) result = compare(pixels, expected.pixels(), tolerance);
  if (is_set("UPDATE_GOLDENS")) {
    const std::string fault = update(name, pixels, file, exists && golden.same_renderer && result.passed);
    if (!fault.empty()) return testing::AssertionFailure() << fault;
    remove_from_page(results_folder(), current_test(), name);
    return testing::AssertionSuccess();
  }
  if (!exists) {
    FailedPicture missing{.test = {},
                          .name = {},
                          .text = words("golden file ", golden.file.string(), " is missing"),
                          .command = {},
                          .comparison = {},
                          .actual = pixels,
                          .expected = {}};
    missing.comparison.severity = 1e9;
    return failure(missing, name);
  }
  record(name, "different_pixels", words(result.different));
  record(name, "severity", words(result.severity));
  if (tolerance.tier == Tier::loose) {
    record(name, "flip_mean", words(result.flip_mean));
    record(name, "flip_p99", words(result.flip_p99));
  } else {
    record(name, "max_difference", words(result.max_difference));
    record(name, "pixels_beyond", words(result.beyond));
  }
  if (!result.passed) {
    FailedPicture different{.test = {},
                            .name = {},
                            .text = result.text,
                            .command = {},
                            .comparison = result,
                            .actual = pixels,
                            .expected = expected.pixels()};
    if (!golden.same_renderer)
      different.text += words(" (golden of another renderer: ", golden.file.string(), ")");
    return failure(different, name);
  }
  remove_from_page(results_folder(), current_test(), name);
  if (const std::string fault = sensitivity_fault(name, pixels, tolerance); !fault.empty())
    return testing::AssertionFailure() << name << ": " << fault;
  return testing::AssertionSuccess();
}

}  // namespace

Settings& settings() {
  static Settings all;
  return all;
}

std::string folder_of_renderer(const std::string& renderer) {
  std::string folder;
  for (const char c : renderer) {
    if (c == ',')
      folder += '_';
    else if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_')
      folder += c;
    else if (!folder.ends_with('_') && !folder.ends_with('-'))
      folder += '-';
  }
  return folder;
}

testing::AssertionResult looks_like(const std::string& name, const Pixels& pixels,
                                    const Tolerance& tolerance) {
  try {
    return check(name, pixels, tolerance);
  } catch (const std::exception& error) {
    return testing::AssertionFailure() << name << ": " << error.what();
  }
}

}  // namespace collidoscope::capture
