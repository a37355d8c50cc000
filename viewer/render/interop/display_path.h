#pragma once
// How what the simulator publishes reaches the GL buffers that are drawn. Chosen once, at start, and always
// reported; a path that fails steps down to the next with one line that says why.

#include <string>

namespace collidoscope {

enum class DisplayPath {
  automatic,  ///< only as a request: the first below that works
  interop,    ///< CUDA writes into mapped GL buffers; nothing visits the host
  copy,       ///< CUDA writes into its own memory, which is copied to the host and uploaded
  upload      ///< the CPU writes plain memory, which is uploaded
};

const char* display_path_name(DisplayPath path);

/// auto, interop, copy or upload. Throws InputError.
DisplayPath parse_display_path(const std::string& text, const std::string& where = "--display-path");

}  // namespace collidoscope
