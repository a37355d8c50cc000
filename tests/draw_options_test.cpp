// Tests the drawing options: defaults by renderer, explicit requests, and the reader of their names.
#include "viewer/render/draw_options.h"

#include <gtest/gtest.h>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

TEST(DrawOptions, ALiveViewTakesWhatItCanAfford) {
  EXPECT_EQ(live_options({}, false, 2000), DrawOptions{});
  EXPECT_EQ(live_options({}, false, max_supersampled).supersampling, 2);
  EXPECT_EQ(live_options({}, false, max_supersampled + 1), (DrawOptions{.supersampling = 1}));
  EXPECT_EQ(live_options({}, true, 2000), (DrawOptions{.supersampling = 1, .light = Quality::quick}));
}

TEST(DrawOptions, WhatIsAskedForIsDone) {
  const DrawRequest request{.supersampling = 3,
                            .light = Quality::full,
                            .spheres = SphereMethod::quads,
                            .light_method = LightMethod::compute};
  const DrawOptions asked{3, Quality::full, SphereMethod::quads, LightMethod::compute};
  EXPECT_EQ(live_options(request, true, 10'000'000), asked);
  EXPECT_EQ(still_options(request, 50'000, 20'000, 16384), asked);
  EXPECT_EQ(still_options({}, 1280, 720, 16384), DrawOptions{});
  EXPECT_EQ(still_options({}, 10'000, 10'000, 32768).supersampling, 1);
  EXPECT_EQ(still_options({}, 16384, 16, 32768).supersampling, 2);
  EXPECT_EQ(still_options({}, 16384, 16, 16384).supersampling, 1);
}

TEST(DrawOptions, NamesAreReadOrRefused) {
  EXPECT_EQ(parse_quality("auto"), std::nullopt);
  EXPECT_EQ(parse_quality("full"), Quality::full);
  EXPECT_EQ(parse_quality(quality_name(Quality::quick)), Quality::quick);
  EXPECT_EQ(parse_sphere_method("compute"), SphereMethod::compute);
  EXPECT_THROW(parse_quality("best"), InputError);
  EXPECT_THROW(parse_sphere_method(""), InputError);
  EXPECT_EQ(parse_light_method("auto"), LightMethod::automatic);
  EXPECT_EQ(parse_light_method("fragments"), LightMethod::fragments);
  EXPECT_EQ(parse_light_method("compute"), LightMethod::compute);
  EXPECT_THROW(parse_light_method("quads"), InputError);
}

}  // namespace
}  // namespace collidoscope
