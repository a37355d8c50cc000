#pragma once
// What files of changes and of criteria have in common: the settings of a change as members of an object of
// JSON. Free functions; faults go to the Reading.

#include "sim_cuda/changes/changes.h"
#include "sim_cuda/scene/object_reader.h"

namespace collidoscope {

/// All that decides the state but bodies to remove and add. Whether it fits a scene is validate()'s business.
void read_settings(Reading& reading, ObjectReader& reader, Change& change);
/// How it runs: blocks, threads, broad_phase.
void read_run_options(Reading& reading, ObjectReader& reader, Change& change);

}  // namespace collidoscope
