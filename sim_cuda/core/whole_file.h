#pragma once
// A file that is whole or as it was. A free function.

#include <string>

namespace collidoscope {

/// Writes `text` under a temporary name beside `file` and renames it; makes the folder. Throws MachineError.
void write_whole_file(const std::string& file, const std::string& text);

}  // namespace collidoscope
