// Tests the timing of render passes: each pass of a frame has one name and a time.
#include "viewer/render/gl/pass_clock.h"

#include <gmock/gmock.h>

#include "tests/gl_fixture.h"

namespace collidoscope {
namespace {

TEST(PassClock, NamesEveryPassOfAFrame) {
  test_context();
  gl::PassClock clock;
  EXPECT_TRUE(clock.read().empty());
  const TestBodies bodies = test_spheres(20, 9, 1);
  Renderer renderer(64, 48);
  renderer.set_scene(frame_scene(bodies.scene, bodies.initial));
  renderer.instances().upload(std::span<const BodyInstance>(bodies.instances));
  for (int frame = 0; frame < 3; ++frame) {
    renderer.draw(scene_camera({}, renderer.scene().bounds, 64.0 / 48), {.spheres = true}, {0, 1}, &clock);
    std::vector<std::string> names;
    double sum = 0;
    for (const auto& [name, ms] : clock.read()) {
      names.emplace_back(name);
      EXPECT_GE(ms, 0);
      sum += ms;
    }
    EXPECT_THAT(names, testing::ElementsAre("shadows", "bodies", "planes", "light", "veils and walls",
                                            "boxes", "contacts", "resolve"));
    EXPECT_GT(sum, 0);
  }
}

}  // namespace
}  // namespace collidoscope
