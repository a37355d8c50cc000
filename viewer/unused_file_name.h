#pragma once
// Names for files that the window writes. A free function.

#include <string>

namespace collidoscope {

/// captures/<stem>.<ending>, with a number if the file exists, so that nothing is overwritten.
std::string unused_file_name(const std::string& stem, const std::string& ending);

}  // namespace collidoscope
