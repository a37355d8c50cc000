#pragma once
// Files as text.

#include <filesystem>
#include <string>

namespace collidoscope::capture {

/// Empty if the file cannot be read.
std::string read_text_file(const std::filesystem::path& file);
/// Writes a file beside its place and renames it. Creates its folder. Throws std::runtime_error.
void write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace collidoscope::capture
