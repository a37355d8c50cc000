#pragma once
// Helpers for tests of a world whose settings and bodies change while it runs.

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "headless/change_replay.h"
#include "tests/executors.h"
#include "tests/test_files.h"
#include "viewer/session/live_world.h"

namespace collidoscope {

/// The Box Collider with a number of bodies.
inline Scene live_box(std::int64_t bodies, Variant variant = Variant::paper) {
  Scene scene;
  scene.box = Box{};
  BoxCollider generator;
  generator.count = bodies;
  generator.variant = variant;
  scene.generators.push_back(generator);
  return scene;
}

/// Applies the settings as edit(Settings&) changes them. Returns the notice.
template <class Edit>
std::string change_settings(LiveWorld& live, Edit edit) {
  Settings request = live.settings();
  edit(request);
  const std::string notice = live.apply(request);
  EXPECT_EQ(live.settings(), request);
  return notice;
}

inline Change remove_body(std::int64_t id) {
  Change change;
  change.remove = {id};
  return change;
}

inline Change add_body(const Body& body) {
  Change change;
  change.add = {body};
  return change;
}

/// The state hash of a run without a window that replays the recorded changes.
inline std::uint64_t replayed_hash(LiveWorld& live, const Scene& scene) {
  const TemporaryFolder folder;
  std::ofstream(folder / "changes.json") << live.changes_text();
  Start start{scene, {}};
  RunOptions options = on_cpu();
  ChangeReplay replay(folder / "changes.json", start, options);
  World world = start.world(options);
  replay.make_due(world);
  while (world.steps() < replay.end()->step) {
    world.step();
    replay.make_due(world);
  }
  EXPECT_EQ(world.state_hash(), replay.end()->state_hash);
  return world.state_hash();
}

}  // namespace collidoscope
