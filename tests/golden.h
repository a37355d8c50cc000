#pragma once
// Compares pictures with golden files. tests/golden holds one folder for each known renderer: each
// combination of renderer, Mesa and ImGui. For a known renderer the comparison is tight: at most 0.1 % of the
// pixels may differ by more than 5/255 per channel, and a missing golden is a failure. An unknown renderer is
// compared loosely with the goldens of another renderer. With COLLIDOSCOPE_TIGHT_GOLDENS=1 it fails. A
// failure writes the picture, the golden and the difference to an HTML page. Only UPDATE_GOLDENS=1 changes
// goldens: it writes to the folder of the current renderer.

#include <filesystem>
#include <string>

#include "tests/golden_files.h"
#include "viewer/render/image.h"

namespace collidoscope {

/// Largest mean of the perceptual difference (FLIP-like) that passes if another renderer drew the golden.
constexpr double loose_bound = 0.02;

/// Checks `picture` against the golden `name` (without folder or extension) in tests/golden, for the current
/// renderer. Returns "" if it passes, else the difference, the command that accepts the picture, and the
/// page.
std::string check_golden(const std::string& name, const Image& picture);
/// The same check. Adds the name to the list of golden files that tests read (golden_files.h).
template <GoldenName name>
std::string check_golden(const Image& picture) {
  static_cast<void>(golden_picture_entry<name>.name());
  return check_golden(std::string(name.text), picture);
}

/// The same check with goldens in another folder, for the renderer `key`. Never writes a golden.
std::string check_golden(const std::filesystem::path& goldens, const std::string& key,
                         const std::string& name, const Image& picture);

/// The PNG to compare with. It may be missing.
struct GoldenPicture {
  std::filesystem::path png;
  bool same_renderer = false;  ///< use the tight comparison
};

/// Returns the golden of a known renderer. For an unknown renderer, returns a golden of another one,
/// preferably with the same ImGui.
GoldenPicture find_golden(const std::filesystem::path& goldens, const std::string& key,
                          const std::string& name);

/// The folder of a renderer's goldens: "llvmpipe_Mesa-22.3.6_ImGui-1.86".
std::string golden_folder(const std::string& key);

/// The comparison of check_golden() without files: returns "" or the difference.
std::string judge(const Image& picture, const Image& golden, bool same_renderer);

/// The current renderer: "llvmpipe, Mesa 22.3.6, ImGui 1.86".
std::string renderer_key();

}  // namespace collidoscope
