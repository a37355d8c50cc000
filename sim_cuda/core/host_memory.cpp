#include "sim_cuda/core/host_memory.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace collidoscope {
namespace {

constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();

/// The number in a file that holds nothing else; "max" is none.
std::optional<std::int64_t> number_in(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::int64_t number = 0;
  if (stream >> number) return number;
  return std::nullopt;
}

std::int64_t free_in_group(const std::filesystem::path& folder, const char* limit, const char* usage) {
  const auto most = number_in(folder / limit), used = number_in(folder / usage);
  return most && used ? std::max<std::int64_t>(*most - *used, 0) : no_limit;
}

}  // namespace

std::int64_t free_host_bytes() {
  std::int64_t free = no_limit;
  std::ifstream memory("/proc/meminfo");
  for (std::string name; memory >> name;) {
    if (name == "MemAvailable:") {
      std::int64_t kibibytes = 0;
      if (memory >> kibibytes) free = 1024 * kibibytes;
      break;
    }
    memory.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  // A process sees the limit of its group at the root of a container; outside of one, along its own path.
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t last = line.rfind(':');
    if (last == std::string::npos) continue;
    const std::filesystem::path path = line.substr(last + 1);
    if (line.starts_with("0::"))
      for (std::filesystem::path at = path;; at = at.parent_path()) {
        free = std::min(free,
                        free_in_group("/sys/fs/cgroup" / at.relative_path(), "memory.max", "memory.current"));
        if (!at.has_relative_path()) break;
      }
    if (line.find(":memory:") != std::string::npos)
      for (const auto& at : {path.relative_path(), std::filesystem::path()})
        free = std::min(free, free_in_group("/sys/fs/cgroup/memory" / at, "memory.limit_in_bytes",
                                            "memory.usage_in_bytes"));
  }
  return free;
}

}  // namespace collidoscope
