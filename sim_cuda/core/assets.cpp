#include "sim_cuda/core/assets.h"

#include <cstdlib>

#include "sim_cuda/core/error.h"

namespace collidoscope {

namespace fs = std::filesystem;

fs::path program_folder() {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  return failed ? fs::current_path() : program.parent_path();
}

std::vector<fs::path> asset_folders() {
  std::vector<fs::path> folders;
  if (const char* named = std::getenv("COLLIDOSCOPE_ASSETS"); named && *named) folders.emplace_back(named);
  for (const char* up : {"..", "../..", "../../.."})
    folders.push_back((program_folder() / up).lexically_normal() / "assets");
  folders.push_back((program_folder() / ".." / "share" / "collidoscope" / "assets").lexically_normal());
  return folders;
}

fs::path asset(const std::string& name) {
  std::string looked;
  for (const fs::path& folder : asset_folders()) {
    std::error_code failed;
    if (fs::path found = folder / name; fs::exists(found, failed)) return found;
    looked += (looked.empty() ? "" : ", ") + folder.string();
  }
  throw MachineError("asset '" + name + "' not found: searched " + looked +
                     "; set COLLIDOSCOPE_ASSETS to the folder that contains it");
}

fs::path cache_folder() {
  const auto folder_of = [](const char* variable) {
    const char* value = std::getenv(variable);
    return fs::path(value != nullptr ? value : "");
  };
  fs::path folder = folder_of("XDG_CACHE_HOME");
  if (!folder.is_absolute()) folder = folder_of("HOME").is_absolute() ? folder_of("HOME") / ".cache" : "";
  return folder.empty() ? folder : folder / "collidoscope";
}

}  // namespace collidoscope
