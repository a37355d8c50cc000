#pragma once
// The list of golden files that tests read. A call of golden_file<"name.json">() or check_golden<"name">()
// adds the file to the list when the program starts, so the list depends on no filter or shard.

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace collidoscope {

/// A string literal as a template argument.
template <std::size_t size>
struct GoldenName {
  char text[size];
  consteval GoldenName(const char (&literal)[size]) { std::copy_n(literal, size, text); }
};

/// A file in tests/golden that is listed as read.
class GoldenFile {
 public:
  explicit GoldenFile(std::string name);
  const std::string& name() const { return name_; }
  std::filesystem::path path() const;

 private:
  std::string name_;
};

/// Constructed before main() in each program that uses it.
template <GoldenName name>
inline const GoldenFile golden_file_entry{name.text};
template <GoldenName name>
inline const GoldenFile golden_picture_entry{std::string(name.text) + ".png"};

/// The path of tests/golden/`name`.
template <GoldenName name>
std::filesystem::path golden_file() {
  return golden_file_entry<name>.path();
}

/// Names of all files that tests read.
const std::set<std::string>& golden_files_read();

/// Files below `folder` that are not in `read`, in order. Each subfolder holds the goldens of one renderer,
/// with the same names.
std::vector<std::string> unread_files(const std::filesystem::path& folder, const std::set<std::string>& read);

}  // namespace collidoscope
