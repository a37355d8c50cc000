#include "tests/golden.h"

#include <imgui.h>

#include <cstdlib>

#include "headless/compare.h"
#include "tests/test_files.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {

std::string renderer_key() {
  const std::string renderer = gl::renderer_name(), version = gl::version_name();
  const std::size_t mesa = version.find("Mesa ");
  const std::string driver =
      mesa == version.npos ? version : version.substr(mesa, version.find(' ', mesa + 5) - mesa);
  return renderer.substr(0, renderer.find(" (")) + ", " + driver + ", ImGui " IMGUI_VERSION;
}

testing::AssertionResult looks_like_golden(const std::string& name, const Image& picture,
                                           const capture::Tolerance& tolerance) {
  capture::Settings& settings = capture::settings();
  settings.goldens = project_file("tests/golden");
  settings.renderer = renderer_key();
  settings.command = "UPDATE_GOLDENS=1 ./dev test -R '^{}$'";
  const char* only_known = std::getenv("COLLIDOSCOPE_TIGHT_GOLDENS");
  const char* updates = std::getenv("UPDATE_GOLDENS");
  if (only_known != nullptr && std::string(only_known) == "1" && updates == nullptr &&
      !std::filesystem::is_directory(settings.goldens / capture::folder_of_renderer(settings.renderer)))
    return testing::AssertionFailure() << "no goldens are of " << settings.renderer;
  capture::Tolerance sensitive = tolerance;
  sensitive.must_detect = 32;
  return capture::looks_like(name, pixels_of(picture), sensitive);
}

}  // namespace collidoscope
