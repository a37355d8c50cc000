// Tests tables of names: lookup in both directions, suggestions for unknown names, and text made safe for a
// terminal.
#include "sim_cuda/scene/names.h"

#include <gtest/gtest.h>

namespace collidoscope {
namespace {

TEST(Names, ThereAndBack) {
  EXPECT_EQ(name_of(variant_names, Variant::scaled), "scaled");
  EXPECT_EQ(value_of(variant_names, "scaled"), Variant::scaled);
  EXPECT_EQ(value_of(variant_names, "Scaled"), std::nullopt);
  EXPECT_EQ(value_of(variant_names, ""), std::nullopt);
  EXPECT_EQ(name_of(spawn_names, static_cast<Spawn>(99)), "?");
}

TEST(Names, EitherOf) {
  EXPECT_EQ(either_of({}), "");
  EXPECT_EQ(either_of(names_in(rotation_update_names)), "first_order or lie_group");
  EXPECT_EQ(either_of(names_in(precision_names)), "f32 or f64");
  EXPECT_EQ(either_of(names_in(variant_names)), "paper, scaled, settled or equal");
}

TEST(Names, NearestIsWithinAThirdOfTheWord) {
  const std::vector<std::string_view> names{"radius", "mass", "material", "velocity"};
  EXPECT_EQ(nearest_name("raduis", names), "radius");
  EXPECT_EQ(nearest_name("velocty", names), "velocity");
  EXPECT_EQ(nearest_name("mas", names), "mass");
  EXPECT_EQ(nearest_name("materiel", names), "material");
  EXPECT_EQ(nearest_name("colour", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 'm'), names), "");
  EXPECT_EQ(nearest_name("radius", {}), "");
}

TEST(Names, UnknownNameSaysWhatIsKnown) {
  EXPECT_EQ(unknown_name("integrator", "verlet", std::array<std::string_view, 1>{"rk4"}),
            "unknown integrator \"verlet\"; expected \"rk4\"");
  EXPECT_EQ(unknown_name("variant", "papr", names_in(variant_names)),
            "unknown variant \"papr\"; did you mean \"paper\"? (paper, scaled, settled or equal)");
  EXPECT_EQ(unknown_name("variant", "huge", names_in(variant_names)),
            "unknown variant \"huge\"; expected paper, scaled, settled or equal");
}

TEST(Names, PrintableKeepsTerminalsSafe) {
  EXPECT_EQ(printable("a\x1b[31m\n"), "a?[31m?");
  EXPECT_EQ(printable(std::string(61, 'x')), std::string(60, 'x') + "...");
  // One byte, then 40 two-byte characters: the cut must not fall inside a character.
  std::string accents = "x";
  for (int i = 0; i < 40; ++i) accents += "\xc3\xa9";
  EXPECT_EQ(printable(accents).size(), 59u + 3u);
}

}  // namespace
}  // namespace collidoscope
