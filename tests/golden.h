#pragma once
// Golden pictures of this project, for the library of capture/. tests/golden has one folder for each known
// renderer: each combination of renderer, Mesa and ImGui. With COLLIDOSCOPE_TIGHT_GOLDENS=1, an unknown
// renderer fails.

#include <collidoscope/capture.h>
#include <string>

#include "tests/golden_files.h"
#include "viewer/render/image.h"

namespace collidoscope {

/// EXPECT_LOOKS_LIKE for the present renderer and tests/golden.
testing::AssertionResult looks_like_golden(const std::string& name, const Image& picture,
                                           const capture::Tolerance& tolerance);
/// The same. Adds the name to the list of golden files that tests read (golden_files.h).
template <GoldenName name>
testing::AssertionResult looks_like_golden(const Image& picture,
                                           const capture::Tolerance& tolerance = capture::tight()) {
  static_cast<void>(golden_picture_entry<name>.name());
  return looks_like_golden(std::string(name.text), picture, tolerance);
}

/// The present renderer: "llvmpipe, Mesa 22.3.6, ImGui 1.86".
std::string renderer_key();

}  // namespace collidoscope
