#include "sim_cuda/core/whole_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sim_cuda/core/error.h"

namespace collidoscope {

void write_whole_file(const std::string& file, const std::string& text) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path target(file), folder = target.parent_path();
  if (!folder.empty()) fs::create_directories(folder, failed);
  const fs::path temporary = file + "." + std::to_string(getpid()) + ".part";
  errno = 0;
  std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  std::string why = stream ? "" : errno != 0 ? std::strerror(errno) : "writing failed";
  if (why.empty()) {
    fs::rename(temporary, target, failed);
    if (failed) why = failed.message();
  }
  if (why.empty()) return;
  fs::remove(temporary, failed);
  throw MachineError("'" + file + "' cannot be written: " + why);
}

}  // namespace collidoscope
