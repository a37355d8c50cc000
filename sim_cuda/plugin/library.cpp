#include "sim_cuda/plugin/library.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <filesystem>
#include <mutex>

#include "sim_cuda/core/error.h"
#include "sim_cuda/plugin/include/collidoscope/broad_phase.h"
#include "sim_cuda/scene/broad_phase_methods.h"

namespace collidoscope {
namespace {

constexpr const char* entry_point = "collidoscope_broad_phase_v1";

struct LoadedLibrary {
  std::string path, what;
  const collidoscope_broad_phase* methods;
  std::string identity;
};
struct LoadedLibraries {
  std::mutex mutex;
  std::deque<LoadedLibrary> all;  // names and descriptions stay where they are
};
LoadedLibraries& loaded_libraries() {
  static LoadedLibraries libraries;
  return libraries;
}

std::string text_of_loader() {
  const char* text = dlerror();
  return text != nullptr ? text : "unknown error";
}

/// `again`: dlopen() returns the old library for a path that it knows, so the file is opened by another name.
void* open_library(const std::string& path, bool again) {
  std::string name = path;
  if (again) {  // the descriptor stays open, because the name must not be used twice
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) throw InputError(fmt::format("{}: {}", path, std::strerror(errno)));
    name = fmt::format("/proc/self/fd/{}", descriptor);
  }
  void* library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw InputError(fmt::format("{}: not loaded: {}", path, text_of_loader()));
  return library;
}

/// Throws InputError for a description that breaks the rules of the header.
void check_description(const std::string& path, const collidoscope_broad_phase* methods) {
  const auto refuse = [&](const std::string& what) { throw InputError(fmt::format("{}: {}", path, what)); };
  if (methods == nullptr) refuse(fmt::format("{} returns NULL, expected a description", entry_point));
  if (methods->version != COLLIDOSCOPE_BROAD_PHASE_VERSION)
    refuse(fmt::format("version {} of collidoscope/broad_phase.h, expected {}", methods->version,
                       COLLIDOSCOPE_BROAD_PHASE_VERSION));
  constexpr std::uint32_t known = COLLIDOSCOPE_HOST | COLLIDOSCOPE_CUDA;
  if (methods->memory == 0 || (methods->memory & ~known) != 0)
    refuse(fmt::format("memory {}, expected COLLIDOSCOPE_HOST, COLLIDOSCOPE_CUDA or both", methods->memory));
  const auto is_valid = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  const std::size_t length = methods->name != nullptr ? strnlen(methods->name, 33) : 0;
  if (length == 0 || length > 32 || !std::all_of(methods->name, methods->name + length, is_valid))
    refuse("a name that is not 1 to 32 of a-z, 0-9 and _");
  if (methods->create == nullptr || methods->destroy == nullptr || methods->find == nullptr)
    refuse("a null pointer for create, destroy or find");
}

/// A line of the description, without control characters.
std::string description_line(const char* text) {
  std::string line = text != nullptr ? std::string(text, strnlen(text, 200)) : "";
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  return line;
}

}  // namespace

bool is_plugin_path(std::string_view text) {
  return text.find('/') != std::string_view::npos || text.ends_with(".so");
}

std::string full_plugin_path(const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path path = fs::canonical(file, failed);
  if (failed) throw InputError(fmt::format("{}: {}", file, failed.message()));
  if (!fs::is_regular_file(path, failed))
    throw InputError(fmt::format("{}: not a file, expected a shared library", file));
  return path.string();
}

std::string file_identity(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) != 0) throw InputError(fmt::format("{}: {}", path, std::strerror(errno)));
  return fmt::format("{}:{}:{}:{}.{:09}", file.st_dev, file.st_ino, file.st_size, file.st_mtim.tv_sec,
                     file.st_mtim.tv_nsec);
}

std::string load_plugin(const std::string& path, const std::string& identity, bool has_wrong_pairs) {
  LoadedLibraries& loaded = loaded_libraries();
  const std::lock_guard lock(loaded.mutex);
  if (file_identity(path) != identity)
    throw InputError(path + ": changed while it was tested, expected a file that stays the same");
  bool again = false;
  for (const LoadedLibrary& each : loaded.all) {
    if (each.path != path) continue;
    if (each.identity == identity) return each.methods->name;
    again = true;
  }
  void* library = open_library(path, again);
  using EntryPoint = const collidoscope_broad_phase* (*)();
  const auto entry = reinterpret_cast<EntryPoint>(dlsym(library, entry_point));
  if (entry == nullptr)
    throw InputError(fmt::format("{}: exports no function {}, expected one as in collidoscope/broad_phase.h",
                                 path, entry_point));
  const collidoscope_broad_phase* methods = entry();
  check_description(path, methods);
  const LoadedLibrary& added =
      loaded.all.emplace_back(LoadedLibrary{path, description_line(methods->description), methods, identity});
  add_broad_phase({.name = methods->name,
                   .what = added.what,
                   .traversal = "plug-in",
                   .cpu_only = (methods->memory & COLLIDOSCOPE_CUDA) == 0,
                   .gpu_only = (methods->memory & COLLIDOSCOPE_HOST) == 0,
                   .plugin = methods,
                   .file = added.path,
                   .has_wrong_pairs = has_wrong_pairs});
  return methods->name;
}

}  // namespace collidoscope
