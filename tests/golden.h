#pragma once
// Pictures against goldens in tests/golden. Tight where the golden was drawn by the same renderer, Mesa and
// ImGui (at most 5/255 a channel on 0.1 % of the pixels), loose elsewhere. A picture that fails leaves
// itself, the golden and the difference in an HTML page. UPDATE_GOLDENS=1 is the one way to change a golden.

#include <string>

#include "tests/golden_files.h"
#include "viewer/render/image.h"

namespace collidoscope {

/// Greatest FLIP-like mean that passes where the golden was drawn by another renderer.
constexpr double loose_bound = 0.02;

/// "" if the picture passes, else what is wrong and where the page lies.
std::string check_golden(const GoldenFile& png, const Image& picture);
/// The same. `name`: of the golden, without folder or ending.
template <GoldenName name>
std::string check_golden(const Image& picture) {
  return check_golden(golden_picture_entry<name>, picture);
}

/// The test of check_golden() without files: "" or what is wrong.
std::string judge(const Image& picture, const Image& golden, bool same_renderer);

/// What draws here: "llvmpipe, Mesa 22.3.6, ImGui 1.86".
std::string renderer_key();

}  // namespace collidoscope
