// Tests the launch map of the window, without a window.

#include "viewer/session/live_launch_map.h"

#include <gmock/gmock.h>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class LiveLaunchMaps : public OnEachExecutor {};
ON_EACH_EXECUTOR(LiveLaunchMaps);

TEST_P(LiveLaunchMaps, AreMeasuredBesideTheRun) {
  World world(box_collider(300), options());
  world.step(10);
  LiveLaunchMap live;
  LaunchMapRequests requests;
  live.follow(1, requests);
  EXPECT_TRUE(live.done()) << "only on request";
  EXPECT_TRUE(live.view(world).cells.empty());
  requests.restart = true;
  live.follow(1, requests);
  EXPECT_TRUE(requests.running);
  EXPECT_FALSE(requests.restart);
  while (!live.done()) {
    live.advance(world, 2, 20);
    world.step();
  }
  const LaunchMapView& map = live.view(world);
  EXPECT_EQ(map.start_state, 10);
  EXPECT_TRUE(map.done);
  ASSERT_TRUE(map.chosen);
  EXPECT_THAT(map.verdict, testing::HasSubstr("pairs"));
  EXPECT_FALSE(map.stages.empty());
  for (const LaunchMapView::Stage& stage : map.stages) {
    EXPECT_EQ(stage.cell_ms.size(), map.cells.size());
    EXPECT_EQ(stage.occupancy.size(), map.cells.size());
    EXPECT_EQ(stage.reference_shape.threads > 0, world.info().on_gpu) << stage.name;
  }
  World other(box_collider(300), options());
  other.step(static_cast<int>(world.steps()));
  EXPECT_EQ(world.state_hash(), other.state_hash()) << "the run is only read";

  live.follow(1, requests);
  EXPECT_FALSE(live.view(world).cells.empty());
  live.follow(2, requests);
  EXPECT_TRUE(live.view(world).cells.empty()) << "another world";
  EXPECT_FALSE(requests.running);
}

TEST_P(LiveLaunchMaps, ShowAnotherHash) {
  World world(box_collider(300), options());
  LiveLaunchMap live;
  live.set_hash([](World& one) { return one.state_hash() ^ (one.launch_shape().threads == 64 ? 1u : 0u); });
  LaunchMapRequests requests;
  requests.restart = true;
  live.follow(1, requests);
  while (!live.done()) live.advance(world, 1, 20);
  EXPECT_THAT(live.view(world).cells,
              testing::Contains(testing::Field(&LaunchCell::state, LaunchCell::State::wrong)));
}

}  // namespace
}  // namespace collidoscope
