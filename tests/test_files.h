#pragma once
// Where a test finds files of the project and leaves files of its own, in a build tree and in a bundle alike.

#include <unistd.h>

#include <filesystem>
#include <string>

#include "sim_cuda/core/assets.h"

namespace collidoscope {

/// A file by its path from the project's root, such as "tests/golden/x.png": in a build the source tree's, in
/// a bundle the bundle's. The file itself need not exist.
inline std::filesystem::path project_file(const std::string& path) {
  return asset("").parent_path().parent_path() / path;
}

/// A fresh folder of this test's own, removed with everything in it at the end of the scope.
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
  /// How many files and folders lie in it.
  std::size_t files() const {
    using Entries = std::filesystem::directory_iterator;
    return static_cast<std::size_t>(std::distance(Entries(path_), Entries()));
  }

 private:
  std::filesystem::path path_;
};

}  // namespace collidoscope
