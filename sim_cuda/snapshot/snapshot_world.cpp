#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"

namespace collidoscope {

Snapshot snapshot_of(World& world) {
  Snapshot snapshot;
  snapshot.scene = world.scene();
  snapshot.state = world.state();
  snapshot.state_hash = world.state_hash();
  snapshot.bodies_hash = hash_of_bodies(world.initial());
  return snapshot;
}

World world_from(const Snapshot& snapshot, const Scene& scene, const RunOptions& options) {
  World world(scene, options, &snapshot.state);
  if (write_scene(scene) == write_scene(snapshot.scene) &&
      hash_of_bodies(world.initial()) != snapshot.bodies_hash)
    throw InputError(
        scene.file +
        ": the bodies of its scene differ from those at saving; a file of meshes or bodies may have changed");
  return world;
}

}  // namespace collidoscope
