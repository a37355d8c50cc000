#pragma once
// Reading a whole text file, with a bound.

#include <cstddef>
#include <string>

namespace collidoscope {

/// The bytes of `file`. Throws InputError, one line that starts with the file's name, where it cannot be
/// opened or read, is a folder, or holds more than `limit` bytes (found before it is read, where the file
/// has a size). A pipe is waited for, and read as far as that. `wanted` says what would be right: "a scene
/// file (.json)".
std::string read_text_file(const std::string& file, std::size_t limit, const std::string& wanted);

}  // namespace collidoscope
