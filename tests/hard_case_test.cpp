// Tests the reader of hard-case folders. Also tests that each quantity in the project's own criteria has an
// injected fault.

#include "sim_cuda/stability/hard_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "sim_cuda/core/error.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* scene_text = R"({"format": "collidoscope-scene", "version": 1,
  "bodies": [{"radius": 1, "position": [0, 0, 2]}]})";

std::string criterion_text(const std::string& group, const std::string& members) {
  return R"({"format": "collidoscope-criterion", "version": 1, "what": "w", "group": ")" + group + "\"" +
         members + "}";
}

class HardCases : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  std::string fault(const std::vector<std::string>& names = {}) {
    try {
      read_hard_cases(folder_.path().string(), names);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

TEST_F(HardCases, AreReadByGroupThenName) {
  for (const auto& [name, group] :
       {std::pair("a", "speed"), std::pair("b", "stacks"), std::pair("c", "speed")}) {
    write(name + std::string(".json"), scene_text);
    write(name + std::string(".criterion.json"), criterion_text(group, R"(, "steps": 3)"));
  }
  write("other.json", scene_text);  // a scene without a criterion
  EXPECT_THAT(hard_case_names(folder_.path().string()), ElementsAre("a", "b", "c"));
  const auto cases = read_hard_cases(folder_.path().string());
  ASSERT_EQ(cases.size(), 3u);
  EXPECT_EQ(cases[0].name + cases[1].name + cases[2].name, "bac");
  EXPECT_EQ(cases[0].scene.bodies.size(), 1u);
  EXPECT_EQ(read_hard_cases(folder_.path().string(), {"c", "c"}).size(), 1u);
  EXPECT_THAT(fault({"stack", "d"}), HasSubstr("unknown hard case \"stack\""));
  EXPECT_THAT(fault({"stack", "d"}), HasSubstr("unknown hard case \"d\"; did you mean \"a\"?"));
}

TEST_F(HardCases, NameFaultsOfAllTheirFiles) {
  write("a.json", scene_text);
  write("a.criterion.json", criterion_text("speed", R"(, "steps": -1)"));
  write("b.json", R"({"format": "collidoscope-scene", "version": 1, "bodies": [{"radius": 0}]})");
  write("b.criterion.json", criterion_text("speed", R"(, "steps": 1)"));
  write("c.json", scene_text);
  write("c.criterion.json",
        criterion_text(
            "speed",
            R"(, "steps": 1, "assertions": [{"quantity": "difference", "scene": "no.json", "at_most": 1}])"));
  write("d.json", scene_text);
  write("d.criterion.json",
        criterion_text(
            "speed", R"(, "steps": 1, "injected_faults": [{"fails": "finite", "set": {"restitution": 2}}])"));
  write("e.criterion.json", criterion_text("speed", R"(, "steps": 1)"));
  const std::string faults = fault();
  EXPECT_THAT(faults, HasSubstr("a.criterion.json:1:"));
  EXPECT_THAT(faults, HasSubstr("b.json:1:"));
  EXPECT_THAT(faults, HasSubstr("no.json"));
  EXPECT_THAT(faults, HasSubstr("d.criterion.json: faults[0].set: materials.default.restitution"));
  EXPECT_THAT(faults, HasSubstr("e.json: cannot be opened"));
  EXPECT_THROW(hard_case_names(folder_ / "nowhere"), InputError);
  EXPECT_THROW(read_hard_cases(project_file("assets/fonts").string()), InputError) << "no case";
}

TEST_F(HardCases, KeepTheLinesOfASceneThatMustBeRefused) {
  write("a.json", R"({"format": "collidoscope-scene", "version": 1, "bodies": [{"radius": 0}]})");
  write("a.criterion.json", criterion_text("bad input", R"(, "refused": ["radius"])"));
  const auto cases = read_hard_cases(folder_.path().string());
  ASSERT_EQ(cases[0].refusal.size(), 1u);
  EXPECT_THAT(cases[0].refusal[0], HasSubstr("bodies[0].radius"));
}

TEST_F(HardCases, FaultsSetWhatTheSceneHas) {
  write("a.json", scene_text);
  write("b.json", scene_text);
  write("a.criterion.json", criterion_text("speed", R"(, "steps": 1, "injected_faults": [
    {"fails": "finite", "set": {"gravity": [0, 0, 5], "friction": 0.5, "substeps": 9}},
    {"fails": "finite", "scene": "b.json"}, {"fails": "finite", "step": 1, "body": 0}])"));
  const auto cases = read_hard_cases(folder_.path().string());
  const HardCase& one = cases[0];
  const Scene set = with_injected_fault(one, one.criterion.injected_faults[0]);
  EXPECT_EQ(set.physics.gravity, Vector3d(0, 0, 5));
  EXPECT_EQ(set.physics.substeps, 9);
  EXPECT_EQ(set.materials[0].friction, 0.5);
  EXPECT_EQ(with_injected_fault(one, one.criterion.injected_faults[1]).file, one.sibling_path("b.json"));
  EXPECT_EQ(with_injected_fault(one, one.criterion.injected_faults[2]).file, one.file);
}

TEST(ProjectCases, EachQuantityThatMustHoldHasAFault) {
  const auto cases = read_hard_cases(project_file("assets/scenes/hard").string());
  EXPECT_GE(cases.size(), 4u);
  for (const HardCase& one : cases) {
    const Criterion& criterion = one.criterion;
    EXPECT_LT(criterion.what.size(), 300u) << one.name;
    EXPECT_GT(criterion.what.size(), 0u) << one.name;
    for (const Assertion& assertion : criterion.assertions) {
      if (assertion.quantity == Quantity::finite) continue;
      EXPECT_TRUE(std::ranges::any_of(criterion.injected_faults,
                                      [&](const InjectedFault& fault) {
                                        return criterion.assertions[fault.assertion].quantity ==
                                               assertion.quantity;
                                      }))
          << one.name << ": no fault shows that this can fail: " << text_of(assertion);
    }
  }
}

}  // namespace
}  // namespace collidoscope
