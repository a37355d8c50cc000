#include "tests/golden_files.h"

#include "tests/test_files.h"

namespace collidoscope {
namespace {

std::set<std::string>& files() {  // a local static: entries are added before main(), in any order
  static std::set<std::string> names;
  return names;
}

}  // namespace

GoldenFile::GoldenFile(std::string name) : name_(std::move(name)) { files().insert(name_); }

std::filesystem::path GoldenFile::path() const { return project_file("tests/golden/" + name_); }

const std::set<std::string>& golden_files_read() { return files(); }

std::vector<std::string> unread_files(const std::filesystem::path& folder,
                                      const std::set<std::string>& read) {
  std::vector<std::string> unread;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::filesystem::path& file = entry.path();
    if (!read.contains(file.filename().string()))
      unread.push_back(std::filesystem::relative(file, folder).string());
  }
  std::ranges::sort(unread);
  return unread;
}

}  // namespace collidoscope
