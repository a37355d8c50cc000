// Tests `capture`: equal bytes for equal input, drawn instances against the world's tree, bodies and
// contacts, and refusals before the run starts.
#include "headless/capture.h"

#include <gmock/gmock.h>

#include <cstring>
#include <fstream>

#include "headless/cli/output_file.h"
#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/gl_fixture.h"
#include "tests/test_files.h"
#include "viewer/render/image.h"
#include "viewer/render/interop/display_link.h"

namespace collidoscope {
namespace {

Scene small_scene() {
  Scene scene;
  scene.name = "A small scene!";
  scene.generators.push_back({.count = 200});
  scene.box = Box{};
  return scene;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string captured(const std::filesystem::path& folder) {
  World world(small_scene(), on_cpu());
  CaptureRequest request;
  request.states = {0, 5};
  request.layers = parse_layers("spheres,bvh:1-4,contacts");
  request.width = 320;
  request.height = 200;
  request.out = folder.string();
  EXPECT_EQ(run_capture(request, world), 0);
  return bytes_of(folder / "a_small_scene_0005.png");
}

TEST(Capture, TwoCapturesAreByteEqual) {
  const TemporaryFolder folder;
  const std::string first = captured(folder / "one"), second = captured(folder / "two/deeper");
  EXPECT_GT(first.size(), 10000u);
  EXPECT_EQ(first, second);
  const Image picture = read_png((folder / "one/a_small_scene_0000.png").string());
  EXPECT_EQ(picture.width, 320);
  EXPECT_EQ(picture.height, 200);
}

// Two spheres fly apart. The Euler step places both g h t / 2 too low.
TEST(Capture, SaysHowFarTheBodiesAreFromTheirGhosts) {
  Scene scene;
  scene.name = "two";
  scene.physics.solver = Solver::impulse;
  scene.physics.integrator = Integrator::semi_implicit_euler;
  scene.physics.gravity = Vector3d(0, 0, -10);
  scene.physics.time_step = 1.0 / 64;
  scene.bodies.resize(2);
  scene.bodies[1].position = Vector3d(20, 0, 0);
  const TemporaryFolder folder;
  CaptureRequest request;
  request.states = {0, 64};
  request.width = 320;
  request.height = 200;
  const auto capture = [&](const char* layers, const char* name) {
    request.layers = parse_layers(layers);
    request.out = (folder / name).string();
    World world(scene, on_cpu());
    testing::internal::CaptureStdout();
    EXPECT_EQ(run_capture(request, world), 0);
    return testing::internal::GetCapturedStdout();
  };
  const std::string said = capture("spheres,ghosts,errors:20", "with");
  EXPECT_THAT(said, testing::HasSubstr("error 0 m rms, 0 m max"));
  EXPECT_THAT(said, testing::HasSubstr("error 0.0781 m rms, 0.0781 m max; reference: event-driven hard "
                                       "spheres, from state 0, exact"));
  EXPECT_THAT(capture("spheres", "without"), testing::Not(testing::HasSubstr("reference")));
  EXPECT_NE(bytes_of(folder / "with/two_0064.png"), bytes_of(folder / "without/two_0064.png"));
}

TEST(Capture, WhatIsDrawnIsTheTree) {
  test_context();
  World world(small_scene(), on_cpu());
  world.step(3);
  world.detect();
  std::vector<std::string> said;
  DisplayLink link(world.info(), DisplayPath::automatic,
                   [&](const std::string& line) { said.push_back(line); });
  EXPECT_EQ(link.path(), DisplayPath::upload);
  InstanceBuffers buffers;
  const TreeLevels tree = world.tree().levels();
  ASSERT_GT(tree.levels.size(), 4u);
  for (int first = 0; first < static_cast<int>(tree.levels.size()); ++first) {
    const int last = std::min(first + 2, static_cast<int>(tree.levels.size()) - 1);
    link.publish(world, {.boxes = true, .first_level = first, .last_level = last}, buffers);
    std::vector<BoxInstance> drawn(static_cast<std::size_t>(buffers.counts.boxes));
    buffers.boxes.read(drawn.data(), drawn.size() * sizeof(BoxInstance));
    std::size_t at = 0;
    for (int level = first; level <= last; ++level)
      for (const TreeLevels::Box& box : tree.levels[static_cast<std::size_t>(level)]) {
        ASSERT_LT(at, drawn.size());
        EXPECT_EQ(std::memcmp(drawn[at].min, box.min, sizeof box.min), 0);
        EXPECT_EQ(std::memcmp(drawn[at].max, box.max, sizeof box.max), 0);
        EXPECT_EQ(drawn[at].level, static_cast<float>(level));
        ++at;
      }
    EXPECT_EQ(at, drawn.size());
  }
  EXPECT_THAT(said, testing::IsEmpty());
}

TEST(Capture, WhatIsDrawnAreTheBodiesAndContacts) {
  test_context();
  World world(small_scene(), on_cpu());
  world.step(3);
  world.detect();
  DisplayLink link(world.info(), DisplayPath::automatic, [](const std::string&) {});
  InstanceBuffers buffers;
  link.publish(world, {.spheres = true, .contacts = true}, buffers);
  const BodyStates states = world.bodies();
  std::vector<BodyInstance> bodies(static_cast<std::size_t>(buffers.counts.bodies));
  buffers.bodies.read(bodies.data(), bodies.size() * sizeof(BodyInstance));
  ASSERT_EQ(bodies.size(), states.position.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_EQ(bodies[i].id, i);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(bodies[i].center[k], static_cast<float>(states.position[i][k]));
    EXPECT_FLOAT_EQ(bodies[i].value, static_cast<float>(states.velocity[i].norm()));
  }
  std::vector<ContactInstance> contacts(static_cast<std::size_t>(buffers.counts.contacts));
  buffers.contacts.read(contacts.data(), contacts.size() * sizeof(ContactInstance));
  ASSERT_GT(contacts.size(), 0u);
  for (const ContactInstance& contact : contacts) {
    const Vector3d a = states.position[contact.a], b = states.position[contact.b];
    const double gap = (b - a).norm() - world.initial().radius[contact.a] - world.initial().radius[contact.b];
    EXPECT_LT(gap, 1e-4);
    EXPECT_NEAR(contact.penetration, -gap, 1e-3);
  }
}

TEST(Capture, APathThatTheMachineLacksStepsDownWithOneLine) {
  test_context();
  World world(small_scene(), on_cpu());
  for (DisplayPath request : {DisplayPath::interop, DisplayPath::copy}) {
    std::vector<std::string> said;
    DisplayLink link(world.info(), request, [&](const std::string& line) { said.push_back(line); });
    EXPECT_EQ(link.path(), DisplayPath::upload);
    EXPECT_THAT(said, testing::ElementsAre(testing::HasSubstr("the simulation runs on the CPU")));
  }
}

TEST(Capture, AFolderThatCannotBeIsRefusedBeforeAnythingRuns) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "in the way";
  EXPECT_THROW(ensure_writable_folder("--out", (folder / "file").string()), InputError);
  EXPECT_THROW(ensure_writable_folder("--out", (folder / "file/below").string()), InputError);
  World world(small_scene(), on_cpu());
  CaptureRequest request;
  request.out = (folder / "file").string();
  EXPECT_THROW(run_capture(request, world), InputError);
  EXPECT_EQ(world.steps(), 0);
  ensure_writable_folder("--out", (folder / "a/b").string());
  EXPECT_TRUE(std::filesystem::is_empty(folder / "a/b"));
}

TEST(Capture, StatesAndSizes) {
  EXPECT_EQ(parse_states("60,0,30,30"), (std::vector<std::int64_t>{0, 30, 60}));
  for (const char* wrong : {"", "1,,2", "-1", "1.5", "x", "99999999999999999999", "3 "})
    EXPECT_THROW(parse_states(wrong), InputError) << wrong;
  CaptureRequest request;
  parse_size("640x480", request);
  EXPECT_EQ(request.width, 640);
  EXPECT_EQ(request.height, 480);
  for (const char* wrong :
       {"", "640", "640x", "x480", "640x480x3", "8x480", "640x99999", "-640x480", "640 x 480"})
    EXPECT_THROW(parse_size(wrong, request), InputError) << wrong;
}

}  // namespace
}  // namespace collidoscope
