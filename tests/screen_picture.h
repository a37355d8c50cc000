#pragma once
// The picture on an X server's screen, from the file that Xvfb writes (-fbdir) in the format of xwd.

#include <string>

#include "viewer/render/image.h"

namespace collidoscope {

/// Reads `width` x `height` pixels at (x, y). Throws std::runtime_error if the file has no screen of 32 bits
/// per pixel, or the screen is smaller.
Image screen_picture(const std::string& file, int x, int y, int width, int height);

}  // namespace collidoscope
