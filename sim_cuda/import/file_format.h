#pragma once
// Detects the format of a file by its content.

#include <string>
#include <string_view>

namespace collidoscope {

enum class FileFormat {
  scene,
  snapshot,
  recording,
  npy,
  npz,
  csv,
  xyz,
  lammps,
  ply,
  stl,
  obj,
  urdf,
  mjcf,
  unknown
};

/// "NumPy array (.npy)".
std::string_view description_of(FileFormat format);

/// Reads the start of the file. Throws InputError if there is no such file.
FileFormat format_of(const std::string& file);
/// The same for the first bytes of a file of `bytes` bytes.
FileFormat format_of_start(std::string_view start, std::size_t bytes);

}  // namespace collidoscope
