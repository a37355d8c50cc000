#pragma once
// Names of files that the window writes. A free function.

#include <string>

namespace collidoscope {

/// captures/<stem>.<ending>, or with a number where that is taken: nothing is overwritten.
std::string unused_file_name(const std::string& stem, const std::string& ending);

}  // namespace collidoscope
