#include "sim_cuda/import/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <thread>
#include <vector>

#include "sim_cuda/core/error.h"

namespace collidoscope {

InputFile::InputFile(const std::string& name, const std::string& wanted) : name_(name) {
  namespace fs = std::filesystem;
  std::error_code failed;
  if (!fs::is_regular_file(name, failed)) {
    const char* const problem = fs::is_directory(name, failed) ? "is a folder"
                                : fs::exists(name, failed)     ? "is no regular file"
                                                               : "not found";
    throw InputError(fmt::format("{}: {}; give the path of {}", name, problem, wanted));
  }
  bytes_ = fs::file_size(name, failed);
  errno = 0;
  file_ = failed ? -1 : ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0)
    throw InputError(fmt::format("{}: cannot be opened ({})", name, std::generic_category().message(errno)));
}

InputFile::~InputFile() { ::close(file_); }

std::size_t InputFile::read(std::size_t offset, void* to, std::size_t bytes) const {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t got =
        ::pread(file_, static_cast<char*>(to) + done, bytes - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

FileText::FileText(const InputFile& file)
    : bytes_(std::make_unique_for_overwrite<char[]>(file.bytes())), size_(file.bytes()) {
  std::atomic<bool> complete = true;
  on_all_cores(size_, std::size_t{4} << 20, [&](std::size_t first, std::size_t last) {
    if (file.read(first, bytes_.get() + first, last - first) != last - first) complete = false;
  });
  if (!complete) throw InputError(fmt::format("{}: cannot be read to its end", file.name()));
}

void detail::share_among_cores(std::size_t count, std::size_t grain,
                               void (*work)(const void* context, std::size_t first, std::size_t last),
                               const void* context) {
  constexpr std::size_t most_threads = 16;
  const std::size_t cores = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, most_threads);
  const std::size_t parts = std::clamp<std::size_t>(count / std::max<std::size_t>(grain, 1), 1, cores);
  std::vector<std::jthread> threads;
  for (std::size_t part = 1; part < parts; ++part) {
    const std::size_t first = count / parts * part;
    const std::size_t last = part + 1 == parts ? count : count / parts * (part + 1);
    try {
      threads.emplace_back(work, context, first, last);
    } catch (const std::system_error&) {  // no more threads
      work(context, first, last);
    }
  }
  work(context, 0, parts == 1 ? count : count / parts);
}

}  // namespace collidoscope
