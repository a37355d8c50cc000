#pragma once
// Compares pictures with goldens. tests/golden holds a folder of goldens for each known renderer, that is for
// each combination of renderer, Mesa and ImGui. There the comparison is tight: at most 0.1 % of the pixels
// differ by more than 5/255 a channel, and a golden that is missing is a failure. An unknown renderer, one
// without a folder, is compared loosely with the goldens of another; with COLLIDOSCOPE_TIGHT_GOLDENS=1 it
// fails. A failure writes the picture, the golden and the difference to an HTML page. UPDATE_GOLDENS=1 is the
// only way to change a golden: it writes to the folder of the renderer at hand.

#include <filesystem>
#include <string>

#include "tests/golden_files.h"
#include "viewer/render/image.h"

namespace collidoscope {

/// Greatest FLIP-like mean that passes where the golden was drawn by another renderer.
constexpr double loose_bound = 0.02;

/// Checks `picture` against the golden `name` (without folder or ending) in tests/golden, for the renderer at
/// hand. Returns "" if it passes, else what is wrong, the command that accepts the picture, and the page.
std::string check_golden(const std::string& name, const Image& picture);
/// The same; the name is in the list of golden files that tests read (golden_files.h).
template <GoldenName name>
std::string check_golden(const Image& picture) {
  static_cast<void>(golden_picture_entry<name>.name());
  return check_golden(std::string(name.text), picture);
}

/// The same against the goldens in another folder and for the renderer `key`; never writes a golden.
std::string check_golden(const std::filesystem::path& goldens, const std::string& key,
                         const std::string& name, const Image& picture);

/// The PNG to compare with. It may be missing.
struct GoldenPicture {
  std::filesystem::path png;
  bool same_renderer = false;  ///< the comparison is tight
};

/// For a known renderer its own golden. Else one of another renderer, with the same ImGui if there is one.
GoldenPicture find_golden(const std::filesystem::path& goldens, const std::string& key,
                          const std::string& name);

/// Name of the folder of a renderer's goldens: "llvmpipe_Mesa-22.3.6_ImGui-1.86".
std::string golden_folder(const std::string& key);

/// The comparison of check_golden() without files: "" or what is wrong.
std::string judge(const Image& picture, const Image& golden, bool same_renderer);

/// The renderer at hand: "llvmpipe, Mesa 22.3.6, ImGui 1.86".
std::string renderer_key();

}  // namespace collidoscope
