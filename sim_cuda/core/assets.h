#pragma once
// Location of the assets: scenes, shaders, fonts. Stateless: each call reads the environment and the path of
// the running program.

#include <filesystem>
#include <string>
#include <vector>

namespace collidoscope {

/// The search path, in order: $COLLIDOSCOPE_ASSETS, then assets/ one, two and three folders above the program
/// (for a bundle's bin/, build/bin/ and build/<preset>/bin/), and share/collidoscope/assets beside an
/// installed bin/.
std::vector<std::filesystem::path> asset_folders();

/// Path of the file or folder `name` ("scenes/box_collider.json") in the first of these folders that contains
/// it. Throws MachineError, which lists the searched folders.
std::filesystem::path asset(const std::string& name);

/// The folder of files that can be computed again: $XDG_CACHE_HOME/collidoscope, else
/// $HOME/.cache/collidoscope. It may not exist. Empty if both variables are unset or relative.
std::filesystem::path cache_folder();

/// The folder of the running program, with symbolic links resolved.
std::filesystem::path program_folder();

}  // namespace collidoscope
