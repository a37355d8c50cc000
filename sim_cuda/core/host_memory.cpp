#include "sim_cuda/core/host_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace collidoscope {
namespace {

constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();

/// Reads the number in a file. Returns nullopt if the text is no number, such as "max".
std::optional<std::int64_t> number_in(const std::string& file) {
  std::ifstream stream(file);
  std::int64_t number = 0;
  if (stream >> number) return number;
  return std::nullopt;
}

// Plain strings instead of std::filesystem::path: that of libstdc++ 12 is corrupted if an allocation fails
// while it grows.
std::int64_t free_in_group(const std::string& folder, const char* limit, const char* usage) {
  const auto max = number_in(folder + '/' + limit), used = number_in(folder + '/' + usage);
  return max && used ? std::max<std::int64_t>(*max - *used, 0) : no_limit;
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
  // In a container the group's limit is at the root of the hierarchy. Outside a container it is along the
  // group's path.
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t last = line.rfind(':');
    if (last == std::string::npos) continue;
    std::string path = line.substr(last + 1);
    while (path.ends_with('/')) path.pop_back();
    if (line.find(":memory:") != std::string::npos)
      for (const std::string& at : {path, std::string()})
        free = std::min(free, free_in_group("/sys/fs/cgroup/memory" + at, "memory.limit_in_bytes",
                                            "memory.usage_in_bytes"));
    if (line.starts_with("0::"))
      for (;; path.resize(path.rfind('/'))) {
        free = std::min(free, free_in_group("/sys/fs/cgroup" + path, "memory.max", "memory.current"));
        if (path.find('/') == std::string::npos) break;
      }
  }
  return free;
}

std::int64_t resident_host_bytes() {
  std::ifstream sizes("/proc/self/statm");  // in pages: size of the address space, then resident size
  std::int64_t all = 0, resident = 0;
  if (!(sizes >> all >> resident)) return 0;
  return resident * sysconf(_SC_PAGESIZE);
}

}  // namespace collidoscope
