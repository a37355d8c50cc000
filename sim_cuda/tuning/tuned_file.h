#pragma once
// Files of launch shapes that `tune` measured (core/tuned_shapes.h): the user's cache and assets/tuned.json.

#include <string>
#include <vector>

#include "sim_cuda/core/tuned_shapes.h"

namespace collidoscope {

/// `file:line:column` precedes each fault. Throws InputError, also if the file cannot be read.
std::vector<TunedShapes> read_tuned(const std::string& file);
std::string write_tuned(const std::vector<TunedShapes>& results);

/// The user's file, which may not exist: tuned.json in the cache folder. Empty: there is no such folder.
std::string tuned_cache();
/// Results of the user's file, then those of assets/tuned.json. A file with a fault is left out, and its
/// fault appended to `warnings`.
std::vector<TunedShapes> known_tuned(std::vector<std::string>& warnings);

/// The text of a file, which may not exist, with a result in place of one with the same conditions. Throws
/// InputError if the file has faults.
std::string with_tuned(const std::string& file, const TunedShapes& result);

}  // namespace collidoscope
