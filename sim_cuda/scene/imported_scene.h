#pragma once
// Scenes from files of other programs.

#include <cstdint>
#include <optional>
#include <string>

#include "sim_cuda/import/file_format.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// Meaning of a file of bodies, if its contents do not tell.
struct ImportOptions {
  std::string columns;           ///< as BodyFile::columns
  std::optional<double> radius;  ///< m, of bodies without one; unset: a quarter of their mean distance
  double scale = 1;              ///< m per unit of length in the file
  std::int64_t frame = 0;        ///< of a file with several, from 0

  bool any() const { return !columns.empty() || radius || scale != 1 || frame != 0; }
};

/// A scene of boxes. `tree`: path of a tree over them in the same folder, or empty. Throws InputError.
Scene import_boxes(const std::string& file, const std::string& tree);

/// A scene of the bodies of a file, without gravity and walls. Its warnings tell what was assumed, and what
/// was not taken from the file. Throws InputError.
Scene import_scene(const std::string& file, FileFormat format, const ImportOptions& options);

}  // namespace collidoscope
