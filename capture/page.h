#pragma once
// The page of the pictures that failed.

#include <filesystem>
#include <string>

#include <collidoscope/capture.h>

namespace collidoscope::capture {

struct FailedPicture {
  std::string test, name;  ///< Suite.Test, and the name of the golden
  std::string text;        ///< what differs
  std::string command;     ///< that accepts the picture
  Comparison comparison;
  Pixels actual, expected;  ///< `expected` may be empty
};

/// Adds a picture to the page in a folder. Each picture has a file of its own there, and the page is made of
/// all of them, the worst first; so the programs of one run, which may run at the same time, have one page.
/// Returns the page. Throws std::runtime_error.
std::filesystem::path add_to_page(const std::filesystem::path& folder, const FailedPicture& failed);
/// Removes a picture that passes now. No effect if it is not on the page.
void remove_from_page(const std::filesystem::path& folder, const std::string& test, const std::string& name);

}  // namespace collidoscope::capture
