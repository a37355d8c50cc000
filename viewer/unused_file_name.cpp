#include "viewer/unused_file_name.h"

#include <fmt/format.h>

#include <filesystem>

namespace collidoscope {

std::string unused_file_name(const std::string& stem, const std::string& ending) {
  namespace fs = std::filesystem;
  std::string file = fmt::format("captures/{}.{}", stem, ending);
  std::error_code failed;  // ignored: writing the file will report the reason
  for (int k = 2; fs::exists(file, failed); ++k) file = fmt::format("captures/{}_{}.{}", stem, k, ending);
  return file;
}

}  // namespace collidoscope
