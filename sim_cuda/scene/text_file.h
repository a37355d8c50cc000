#pragma once
// Reads a text file of bounded size.

#include <cstddef>
#include <string>

namespace collidoscope {

/// The bytes of `file`. Throws InputError if it cannot be opened or read, is a folder, or exceeds `limit`
/// bytes. The message is one line that starts with the file name.
/// A regular file is checked before it is read. A pipe is read until the limit is exceeded. `wanted`
/// describes the expected file: "a scene file (.json)".
std::string read_text_file(const std::string& file, std::size_t limit, const std::string& wanted);

}  // namespace collidoscope
