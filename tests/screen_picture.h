#pragma once
// What an X server shows: the file that Xvfb keeps of its screen (-fbdir), in the format of xwd. A free
// function.

#include <string>

#include "viewer/render/image.h"

namespace collidoscope {

/// `width` x `height` pixels of the screen from (x, y) on. Throws std::runtime_error where the file is none
/// of a screen with 32 bits per pixel, or the screen is smaller.
Image screen_picture(const std::string& file, int x, int y, int width, int height);

}  // namespace collidoscope
