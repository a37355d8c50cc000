// Tests the parser of layer lists (`--layers`): names, ranges, magnifications, and one message per fault.
#include "viewer/render/frame_layers.h"

#include <gmock/gmock.h>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::vector<std::string> faults(const std::string& text) {
  try {
    parse_layers(text);
  } catch (const InputError& error) {
    return error.lines();
  }
  return {};
}

TEST(FrameLayers, ReadsNamesAndRanges) {
  FrameLayers expected{.spheres = true, .boxes = true, .first_level = 2, .last_level = 5, .contacts = true};
  EXPECT_EQ(parse_layers("spheres,bvh:2-5,contacts"), expected);
  EXPECT_EQ(parse_layers("bvh:7"), (FrameLayers{.boxes = true, .first_level = 7, .last_level = 7}));
  EXPECT_EQ(parse_layers("bvh"), (FrameLayers{.boxes = true, .first_level = 0, .last_level = 63}));
  EXPECT_EQ(parse_layers("spheres,no-grid,no-walls,no-joints,no-overlay"),
            (FrameLayers{.spheres = true, .joints = false, .grid = false, .walls = false, .overlay = false}));
}

TEST(FrameLayers, ErrorsInSomeMagnification) {
  EXPECT_EQ(parse_layers("ghosts,errors"), (FrameLayers{.ghosts = true, .errors = true}));
  EXPECT_EQ(parse_layers("errors:100"), (FrameLayers{.errors = true, .error_scale = 100}));
  for (const char* wrong :
       {"errors:", "errors:0", "errors:-3", "errors:1.5", "errors:x", "errors:1000000001"})
    EXPECT_THAT(faults(wrong), testing::ElementsAre(HasSubstr("not a magnification"))) << wrong;
  EXPECT_EQ(parse_body_color("error"), BodyColor::error);
}

TEST(FrameLayers, EveryFaultHasItsLine) {
  EXPECT_THAT(
      faults("bhv,spheres,bvh:5-2"),
      testing::ElementsAre(
          AllOf(StartsWith("--layers: 'bhv': unknown layer; expected one of spheres"), HasSubstr("contacts")),
          HasSubstr("'bvh:5-2': not a range of levels")));
  for (const char* wrong :
       {"bvh:", "bvh:-3", "bvh:3-", "bvh:a-b", "bvh:2-64", "bvh:1-2-3", "bvh: 2", "bvh:99999999999"})
    EXPECT_THAT(faults(wrong), testing::ElementsAre(HasSubstr("not a range of levels"))) << wrong;
  EXPECT_TRUE(parse_layers("spheres,ui").ui);
  EXPECT_FALSE(parse_layers("spheres").ui);
  EXPECT_TRUE(parse_layers("ui:convergence").ui && parse_layers("ui:convergence").convergence);
  EXPECT_THAT(faults("bvh:1,bvh:2"), testing::ElementsAre(HasSubstr("second range")));
  EXPECT_THAT(faults(""), testing::ElementsAre(HasSubstr("'': unknown layer")));
  EXPECT_THAT(faults("spheres,"), testing::SizeIs(1));
}

TEST(FrameLayers, Colours) {
  EXPECT_EQ(parse_body_color("contacts"), BodyColor::contacts);
  EXPECT_EQ(parse_body_color("depth"), BodyColor::depth);
  EXPECT_THROW(parse_body_color("deep"), InputError);
  EXPECT_EQ(parse_box_color("overlap"), NodeMetric::sibling_overlap);
  EXPECT_THROW(parse_box_color("speed"), InputError);
}

TEST(FrameLayers, RangesOfBoxes) {
  FrameLayers layers;
  parse_box_range("0.25,1e3", layers);
  EXPECT_EQ(layers.box_low, 0.25f);
  EXPECT_EQ(layers.box_high, 1000.0f);
  parse_box_range("7,inf", layers);
  EXPECT_EQ(layers.box_high, std::numeric_limits<float>::infinity());
  for (const char* wrong : {"", "3", "3,", ",3", "4,3", "-1,3", "a,b", "1,2,3", "nan,1", "0,nan", " 1,2"})
    EXPECT_THROW(parse_box_range(wrong, layers), InputError) << wrong;
  EXPECT_EQ(layers.box_low, 7.0f) << "what is wrong changes nothing";
}

}  // namespace
}  // namespace collidoscope
