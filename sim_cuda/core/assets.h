#pragma once
// Where the files that travel with the programs are: scenes, shaders, fonts. No state; reads the environment
// and the place of the running program at each call.

#include <filesystem>
#include <string>
#include <vector>

namespace collidoscope {

/// The folders that are searched, in order: $COLLIDOSCOPE_ASSETS, then assets/ one, two and three folders
/// above the program (a bundle's bin/, build/bin/ and build/<preset>/bin/).
std::vector<std::filesystem::path> asset_folders();

/// The file or folder `name` ("scenes/box_collider.json") under the first of them that has it. Throws
/// MachineError, which lists where it looked.
std::filesystem::path asset(const std::string& name);

/// The folder that the running program lies in, links resolved.
std::filesystem::path program_folder();

}  // namespace collidoscope
