#include "sim_cuda/scene/relocated_scene.h"

#include <fmt/format.h>

#include <filesystem>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

std::string path_from(const std::string& folder, const std::string& directory, const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path file = fs::weakly_canonical(fs::path(directory) / path, failed);
  return file.lexically_relative(fs::weakly_canonical(folder, failed)).string();
}

}  // namespace

Scene relocated_scene(Scene scene, const std::string& folder) {
  for (std::vector<Body>* bodies : {&scene.bodies, &scene.extra_bodies})
    for (Body& body : *bodies)
      if (body.shape == Shape::mesh) body.mesh = path_from(folder, scene.directory, body.mesh);
  const auto relocate = [&](std::string& file) {
    std::string path = path_from(folder, scene.directory, file);
    if (path.empty() || path.starts_with(".."))
      throw InputError(
          fmt::format("{} is not in the folder of the scene, {}; expected a scene beside it", file, folder));
    file = std::move(path);
  };
  for (BodyFile& file : scene.body_files) {
    relocate(file.path);
    if (!file.tree.empty()) relocate(file.tree);
  }
  scene.directory = folder;
  return scene;
}

}  // namespace collidoscope
