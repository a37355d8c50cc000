#include "capture/text_file.h"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace collidoscope::capture {

std::string read_text_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_text_file(const std::filesystem::path& file, const std::string& text) {
  namespace fs = std::filesystem;
  std::error_code failed;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), failed);
  const fs::path partial = file.string() + "." + std::to_string(getpid()) + ".part";
  std::ofstream stream(partial, std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (stream) fs::rename(partial, file, failed);
  if (stream && !failed) return;
  std::error_code ignored;
  fs::remove(partial, ignored);
  throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace collidoscope::capture
