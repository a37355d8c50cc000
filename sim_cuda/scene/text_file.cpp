#include "sim_cuda/scene/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"

namespace collidoscope {

namespace {

std::string read_bounded(const std::string& file, std::size_t limit, const std::string& wanted) {
  const auto refuse = [&](const std::string& what) {
    return InputError(fmt::format("{}: {}; give the path of {}", file, what, wanted));
  };
  const auto too_large = [&] {
    return refuse(fmt::format("larger than {} MiB, the maximum size", limit >> 20));
  };
  std::error_code ignored;
  std::string text;
  if (std::filesystem::is_directory(file, ignored)) throw refuse("is a folder");
  if (std::filesystem::is_regular_file(file, ignored)) {
    const auto size = std::filesystem::file_size(file, ignored);
    if (!ignored && size > limit) throw too_large();
    if (!ignored) text.reserve(static_cast<std::size_t>(size));
  }

  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream) throw refuse("cannot be opened (" + std::generic_category().message(errno) + ")");
  char block[1 << 16];
  while (const std::size_t got = std::fread(block, 1, sizeof block, stream.get())) {
    if (text.size() + got > limit) throw too_large();
    text.append(block, got);
  }
  if (std::ferror(stream.get())) {
    throw refuse("cannot be read (" + std::generic_category().message(errno) + ")");
  }
  return text;
}

}  // namespace

std::string read_text_file(const std::string& file, std::size_t limit, const std::string& wanted) {
  return with_allocation_context("reading a file", [&] { return read_bounded(file, limit, wanted); });
}

}  // namespace collidoscope
