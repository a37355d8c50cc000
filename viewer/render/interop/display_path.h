#pragma once
// Transfer path from the simulator to the GL buffers. Selected once at start and always reported. If a path
// fails, the next one is used, with one line that gives the reason.

#include <string>

namespace collidoscope {

enum class DisplayPath {
  automatic,  ///< request only: the first path that works
  interop,    ///< CUDA writes into mapped GL buffers, without host copies
  copy,       ///< CUDA writes device memory, which is copied to the host and uploaded
  upload      ///< the CPU writes host memory, which is uploaded
};

const char* display_path_name(DisplayPath path);

/// Parses auto, interop, copy or upload. Throws InputError.
DisplayPath parse_display_path(const std::string& text, const std::string& where = "--display-path");

}  // namespace collidoscope
