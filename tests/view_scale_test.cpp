// Tests the resolution scale of the 3D view with simulated renderers: time budget, limits and stability.
#include "viewer/view/view_scale.h"

#include <gtest/gtest.h>

#include <set>

namespace collidoscope {
namespace {

/// The final scale for a renderer with the time `fixed` plus `whole` for all pixels.
double settled(ViewScale& scale, double fixed, double whole) {
  for (int frame = 0; frame < 60; ++frame) {
    const double time = fixed + whole * scale.scale() * scale.scale();
    scale.took(scale.scale(), time);
    scale.changed(time + 0.005);
  }
  return scale.scale();
}

TEST(ViewScale, AFastRendererDrawsEveryPixel) {
  ViewScale scale;
  EXPECT_EQ(settled(scale, 0.001, 0.010), 1);
}

TEST(ViewScale, ASlowOneKeepsTheTimeWhereItCan) {
  ViewScale scale;
  const double found = settled(scale, 0, 0.040);
  EXPECT_LT(found, 1);
  EXPECT_LE(0.040 * found * found, 1.1 * ViewScale::budget);
  EXPECT_GT(found, 0.625) << "no coarser than it must be";
  EXPECT_EQ(settled(scale, 0, 10), 0.625) << "and never too coarse to look at";
  EXPECT_EQ(settled(scale, 0.001, 0.005), 1) << "recovers";
}

TEST(ViewScale, WhatChangesSeldomIsDrawnInFull) {
  ViewScale scale;
  settled(scale, 0, 0.1);
  EXPECT_EQ(scale.scale(), 0.625);
  scale.changed(1);
  EXPECT_EQ(scale.scale(), 1) << "a step in a second leaves time";
  scale.changed(0.05);
  EXPECT_EQ(scale.scale(), 0.625);
}

TEST(ViewScale, DoesNotFlicker) {
  for (double whole = 0.02; whole < 0.12; whole *= 1.03) {
    ViewScale scale;
    settled(scale, 0.004, whole);
    std::set<double> seen;
    for (int frame = 0; frame < 200; ++frame) {
      const double noise = frame % 2 == 0 ? 1.15 : 0.85;
      scale.changed(0);
      scale.took(scale.scale(), noise * (0.004 + whole * scale.scale() * scale.scale()));
      seen.insert(scale.scale());
    }
    EXPECT_LE(seen.size(), 2u) << whole;
  }
}

}  // namespace
}  // namespace collidoscope
