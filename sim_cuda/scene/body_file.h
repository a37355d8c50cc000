#pragma once
// Bodies of foreign files within a scene.

#include <string>

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// Reads the file into `file.table`. The path must lead to a file in `directory`. Throws InputError; its
/// lines begin with the path of the file.
void read_body_file(const std::string& directory, BodyFile& file);

/// Appends the bodies of a file whose table has been read. Optional arrays of `all` may be shorter than the
/// number of bodies; missing values are the default.
void append_body_file(const BodyFile& file, double density, InitialBodies& all);

}  // namespace collidoscope
