#pragma once
// A PNG in memory.

#include <string>

#include <collidoscope/picture.h>

namespace collidoscope::capture {

/// RGB if all pixels are opaque, else RGBA. Equal pixels give equal bytes. Throws std::runtime_error.
std::string png_bytes(const Pixels& pixels);

}  // namespace collidoscope::capture
