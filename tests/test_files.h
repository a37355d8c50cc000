#pragma once
// Locations of the project's files and of temporary files, in a build tree and in a bundle.

#include <unistd.h>

#include <filesystem>
#include <set>
#include <string>

#include "sim_cuda/core/assets.h"

namespace collidoscope {

/// Resolves a path relative to the project root, such as "tests/golden/x.png": in the source tree for a
/// build, in the bundle for a bundle. The file need not exist.
inline std::filesystem::path project_file(const std::string& path) {
  return asset("").parent_path().parent_path() / path;
}

/// A new temporary folder, deleted with its contents at the end of the scope.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "collidoscope-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::filesystem::filesystem_error("mkdtemp", name, std::error_code{});
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  /// The number of files and folders in it.
  std::size_t files() const {
    using Entries = std::filesystem::directory_iterator;
    return static_cast<std::size_t>(std::distance(Entries(path_), Entries()));
  }
  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      names.insert(entry.path().filename());
    return names;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace collidoscope
