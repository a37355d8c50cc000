#pragma once
// Loads broad-phase plug-ins (include/collidoscope/broad_phase.h). Code of a library runs from its loading
// on, with the rights of the user. Libraries are named by flags and by dropped files only, never by scenes,
// settings or recordings.

#include <string>
#include <string_view>

namespace collidoscope {

/// Whether a value of --broad-phase is the path of a library instead of a name: it has a "/" or ends in
/// ".so".
bool is_plugin_path(std::string_view text);

/// The full path of a library, without links. Throws InputError if it is not a file that can be read.
std::string full_plugin_path(const std::string& file);

/// Changes if the file is replaced or written. Throws InputError if there is no file.
std::string file_identity(const std::string& path);

/// Loads a library into this process, until the process ends, and adds its broad phase to the known ones. A
/// file that has changed since it was loaded is loaded again; its new broad phase replaces the old one for
/// later worlds. `path`: from full_plugin_path(). `identity`: of the file that was tested; another one is not
/// loaded. Returns the name of the broad phase. Throws InputError.
std::string load_plugin(const std::string& path, const std::string& identity, bool has_wrong_pairs);

}  // namespace collidoscope
