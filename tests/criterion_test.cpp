// Tests the reader of criterion files: every field, and every fault with its line and column.

#include "sim_cuda/stability/criterion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/core/error.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Scene five_spheres() {
  Scene scene = empty_space();
  for (int k = 0; k < 5; ++k) scene.bodies.push_back(sphere(1, Vector3d(3 * k, 0, 0)));
  return scene;
}

/// A criterion with the required members and `members`.
std::string text(const std::string& members) {
  return R"({"format": "collidoscope-criterion", "version": 1, "what": "it stands", "group": "stacks",
)" + members +
         "}";
}

Criterion parse(const std::string& members) {
  const Scene scene = five_spheres();
  return parse_criterion(text(members), "c", &scene);
}

std::string fault_of(const std::string& members) {
  try {
    parse(members);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Criterion, ReadsAllThatItMaySay) {
  const Criterion c = parse(R"("steps": 300, "long_steps": 100000, "every": 10,
    "run": {"initial_pair_capacity": 16, "broad_phase": "brute_force", "blocks": 3, "threads": 32, "key_bits": 63},
    "changes": "x.changes.json", "executors": ["cuda"],
    "assertions": [
      {"quantity": "penetration", "at_most": 0.01, "from": 60, "to": 300},
      {"quantity": "position", "body": 3, "axis": "z", "at_least": 0.9, "at_most": 1.1},
      {"quantity": "displacement", "since": 20, "at_most": 1},
      {"quantity": "difference", "scene": "y.json", "offset": [1, 2, 3], "at_most": 1},
      {"quantity": "other_hash", "shapes": [[1, 2], [7, 32]], "broad_phases": ["refit"], "at_most": 0},
      {"quantity": "position", "axis": "x", "at_least": 0}],
    "limits": [{"solver": "impulse", "precision": "f32", "executor": "cpu", "why": "sinks",
      "fails": [{"quantity": "penetration", "at_most": 1}]}],
    "injected_faults": [
      {"fails": "penetration", "step": 100, "body": 4, "position": [0, null, "inf"], "orientation": [2, 0, 0, "-inf"]},
      {"fails": "position", "term": 2, "set": {"solver": "impulse", "substeps": 1, "time_step": 0.1, "restitution": 1,
       "gravity": [0, 0, -100], "friction": 0.5}},
      {"fails": "finite", "scene": "z.json"}])");
  EXPECT_EQ(c.what, "it stands");
  EXPECT_EQ(c.group, "stacks");
  EXPECT_EQ(c.steps, 300);
  EXPECT_EQ(c.long_steps, 100000);
  EXPECT_EQ(c.every, 10);
  EXPECT_EQ(c.run.get<&RunOptions::initial_pair_capacity>(), 16);
  EXPECT_EQ(c.run.get<&RunOptions::broad_phase>(), "brute_force");
  EXPECT_EQ(c.run.get<&LaunchShape::blocks>(), 3);
  EXPECT_EQ(c.run.get<&LaunchShape::threads>(), 32);
  EXPECT_EQ(c.run.get<&ExecutorOptions::key_bits>(), 63);
  EXPECT_EQ(c.changes, "x.changes.json");
  EXPECT_THAT(c.executors, ElementsAre(ExecutorKind::cuda));

  ASSERT_EQ(c.assertions.size(), 7u);
  EXPECT_EQ(text_of(c.assertions[0]), "all finite");
  EXPECT_EQ(text_of(c.assertions[1]), "penetration at most 0.01 m, states 60 to 300");
  EXPECT_EQ(text_of(c.assertions[2]), "position z of body 3 0.9 m to 1.1 m");
  EXPECT_EQ(text_of(c.assertions[3]), "displacement since state 20 at most 1 m");
  EXPECT_EQ(text_of(c.assertions[4]), "difference from y at most 1 m");
  EXPECT_EQ(text_of(c.assertions[5]), "other_hash at most 0");
  EXPECT_EQ(text_of(c.assertions[6]), "position x at least 0 m");
  EXPECT_TRUE(c.assertions[1].at(60) && c.assertions[1].at(300) && !c.assertions[1].at(59) &&
              !c.assertions[1].at(301));
  EXPECT_EQ(c.assertions[4].offset, Vector3d(1, 2, 3));
  ASSERT_EQ(c.assertions[5].shapes.size(), 2u);
  EXPECT_EQ(c.assertions[5].shapes[1].threads, 32);
  EXPECT_THAT(c.assertions[5].broad_phases, ElementsAre("refit"));

  ASSERT_EQ(c.injected_faults.size(), 3u);
  EXPECT_EQ(c.injected_faults[0].assertion, 1u);
  EXPECT_EQ(c.injected_faults[0].state->body, 4u);
  EXPECT_TRUE(std::isnan((*c.injected_faults[0].state->position)[1]));
  EXPECT_TRUE(std::isinf((*c.injected_faults[0].state->position)[2]));
  EXPECT_EQ(c.injected_faults[0].state->orientation->w(), 2);
  EXPECT_EQ(c.injected_faults[1].assertion, 6u) << "the second of this quantity";
  EXPECT_EQ(c.injected_faults[1].set->get<&Physics::solver>(), Solver::impulse);
  EXPECT_EQ(c.injected_faults[1].set->get<&Physics::gravity>(), Vector3d(0, 0, -100));
  EXPECT_EQ(c.injected_faults[1].set->get<&Material::friction>(), 0.5);
  EXPECT_EQ(c.injected_faults[2].assertion, 0u);
  EXPECT_EQ(c.injected_faults[2].scene, "z.json");
}

TEST(Criterion, MayCompareWithEveryBroadPhaseThatThereIs) {
  const Criterion c = parse(R"("steps": 1, "assertions": [
      {"quantity": "other_hash", "broad_phases": ["all"], "at_most": 0}])");
  ASSERT_EQ(c.assertions.size(), 2u);  // the finite check and this one
  EXPECT_TRUE(c.assertions[1].every_broad_phase);
  EXPECT_TRUE(c.assertions[1].broad_phases.empty());
}

TEST(Criterion, ALimitIsOfAllThatItDoesNotName) {
  const Criterion c = parse(R"("steps": 1,
    "assertions": [{"quantity": "speed", "at_most": 1}, {"quantity": "speed", "at_least": 0.5}], "limits": [
    {"solver": "impulse", "why": "a", "fails": [{"quantity": "speed", "at_most": 2},
      {"quantity": "speed", "term": 2, "at_least": 0.25}]},
    {"precision": "f32", "executor": "cuda", "why": "b", "fails": [{"quantity": "speed", "at_most": 2}]}])");
  const auto why = [&](Solver solver, Precision precision, ExecutorKind executor) {
    const ExpectedFailure* limit = c.expected_failure_of(solver, precision, executor);
    return limit == nullptr ? "" : limit->why;
  };
  ASSERT_EQ(c.expected_failures.size(), 2u);
  const ExpectedFailure& first = c.expected_failures[0];
  ASSERT_EQ(first.fails.size(), 2u);
  EXPECT_EQ(first.term_of(0), nullptr) << "all finite";
  ASSERT_NE(first.term_of(2), nullptr);
  EXPECT_EQ(first.term_of(2)->at_least, 0.25);
  EXPECT_EQ(text_of(c.assertions[1], *first.term_of(1)), "speed at most 2 m/s");
  EXPECT_EQ(c.expected_failures[1].term_of(2), nullptr);
  EXPECT_EQ(why(Solver::impulse, Precision::f64, ExecutorKind::cpu), "a");
  EXPECT_EQ(why(Solver::impulse, Precision::f32, ExecutorKind::cuda), "a");
  EXPECT_EQ(why(Solver::soft_step, Precision::f32, ExecutorKind::cuda), "b");
  EXPECT_EQ(why(Solver::soft_step, Precision::f32, ExecutorKind::cpu), "");
  EXPECT_EQ(why(Solver::soft_step, Precision::f64, ExecutorKind::cuda), "");
}

TEST(Criterion, ALimitHasTermsWithWiderBounds) {
  const auto fault = [](const std::string& fails) {
    return fault_of(R"("steps": 1, "assertions": [{"quantity": "speed", "at_most": 1}],
      "limits": [{"solver": "impulse", "why": "a")" +
                    fails + "}]");
  };
  EXPECT_EQ(fault(R"(, "fails": [{"quantity": "speed", "at_most": 2}])"), "");
  EXPECT_THAT(fault(""), HasSubstr("must have \"fails\""));
  EXPECT_THAT(fault(R"(, "fails": [])"), HasSubstr("must have \"fails\""));
  EXPECT_THAT(fault(R"(, "fails": [{"quantity": "speed"}])"),
              HasSubstr("must have the bound that still holds"));
  EXPECT_THAT(fault(R"(, "fails": [{"quantity": "speed", "at_most": 1}])"), HasSubstr("must be above"));
  EXPECT_THAT(fault(R"(, "fails": [{"quantity": "speed", "at_least": 0}])"), HasSubstr("must be below"));
  EXPECT_THAT(fault(R"(, "fails": [{"quantity": "penetration", "at_most": 2}])"),
              HasSubstr("\"assertions\" has none of the quantity \"penetration\""));
  EXPECT_THAT(fault(R"(, "fails": [{"quantity": "finite", "at_most": 2}])"), HasSubstr("cannot be a limit"));
  EXPECT_THAT(fault(R"(, "fails": [{"quantity": "speed", "term": 2, "at_most": 2}])"), HasSubstr("has 1 of"));
  EXPECT_THAT(
      fault(R"(, "fails": [{"quantity": "speed", "at_most": 2}, {"quantity": "speed", "at_most": 3}])"),
      HasSubstr("listed twice"));
}

TEST(Criterion, MayBeMadeForSomeSolvers) {
  EXPECT_THAT(parse(R"("steps": 1, "solvers": ["soft_step"])").solvers, ElementsAre(Solver::soft_step));
  EXPECT_THAT(fault_of(R"("steps": 1, "solvers": ["soft"])"), HasSubstr("\"solvers\" must be a list of"));
}

TEST(Criterion, OfASceneThatIsRefused) {
  const Criterion c = parse(R"("refused": ["radius", "mass"])");
  EXPECT_THAT(c.refused, ElementsAre("radius", "mass"));
  EXPECT_THAT(fault_of(R"("refused": [])"), HasSubstr("at least one string"));
  EXPECT_THAT(fault_of(R"("refused": ["a"], "steps": 3)"), HasSubstr("c:2:"));
}

TEST(Criterion, OfWhatGuardsMustFind) {
  const Criterion c = parse(R"("steps": 10, "expect_finding": {"step": 8, "stage": "bounds", "body": 3},
    "inject": {"step": 7, "body": 3, "position": [null, 0, 0]}, "injected_faults": [{"fails": "found", "step": 7, "body": 2,
    "position": [null, 0, 0]}])");
  ASSERT_TRUE(c.expected_finding && c.injected_state);
  EXPECT_EQ(c.expected_finding->step, 8);
  EXPECT_EQ(c.expected_finding->stage, "bounds");
  EXPECT_EQ(c.expected_finding->body, 3u);
  EXPECT_TRUE(std::isnan((*c.injected_state->position)[0]));
  ASSERT_EQ(c.assertions.size(), 1u) << "what is planted need not be finite";
  EXPECT_EQ(c.assertions[0].quantity, Quantity::expected_finding);
  EXPECT_EQ(c.injected_faults[0].assertion, 0u);
  EXPECT_THAT(fault_of(R"("steps": 10, "inject": {"step": 7, "body": 3, "position": [null, 0, 0]})"),
              HasSubstr("is valid only with \"expect_finding\""));
  EXPECT_THAT(fault_of(R"("steps": 10, "expect_finding": {"step": 8, "body": 3})"),
              HasSubstr("a \"stage\" and a"));
  EXPECT_THAT(
      fault_of(R"("steps": 10, "expect_finding": {"step": 8, "stage": "a", "body": 3}, "assertions": [])"),
      HasSubstr("remove \"expect_finding\" or \"assertions\""));
}

TEST(Criterion, NamesEveryFaultByLineAndColumn) {
  EXPECT_EQ(fault_of(R"("steps": 10, "assertions": [{"quantity": "penetraton", "at_most": 1}])"),
            "c:2:42: unknown quantity \"penetraton\"; did you mean \"penetration\"? (there are 26)");
  const std::pair<const char*, const char*> faults[] = {
      {R"("assertions": [])", "\"steps\" is missing"},
      {R"("steps": -1)", "\"steps\" must be a whole number from 0 to"},
      {R"("steps": 10, "long_steps": 5)", "\"long_steps\" must be a whole number from 10 to"},
      {R"("steps": 10, "every": 0)", "\"every\" must be a whole number from 1"},
      {R"("steps": 10, "assertions": [{"at_most": 1}])", "a term must have a \"quantity\""},
      {R"("steps": 10, "assertions": [{"quantity": "finite", "at_most": 1}])", "is always checked"},
      {R"("steps": 10, "assertions": [{"quantity": "found", "at_least": 1}])",
       "is set by \"expect_finding\" beside"},
      {R"("steps": 10, "assertions": [{"quantity": "speed"}])", "a term must have a bound"},
      {R"("steps": 10, "assertions": [{"quantity": "speed", "at_most": 1, "at_least": 2}])",
       "must not exceed \"at_most\""},
      {R"("steps": 10, "assertions": [{"quantity": "speed", "at_most": 1, "from": 11}])",
       "\"from\" must be a whole"},
      {R"("steps": 10, "assertions": [{"quantity": "speed", "at_most": 1, "from": 5, "to": 4}])",
       "before \"from\""},
      {R"("steps": 10, "assertions": [{"quantity": "speed", "at_most": 1, "body": 1}])",
       "unknown key \"body\""},
      {R"("steps": 10, "assertions": [{"quantity": "position", "at_most": 1, "body": 5, "axis": "x"}])",
       "\"body\" must be a whole number from 0 to 4, not 5"},
      {R"("steps": 10, "assertions": [{"quantity": "position", "at_most": 1}])", "must have an \"axis\""},
      {R"("steps": 10, "assertions": [{"quantity": "difference", "at_most": 1}])", "must have a \"scene\""},
      {R"("steps": 10, "assertions": [{"quantity": "difference", "at_most": 1, "scene": "../a.json"}])",
       "the criterion's own folder"},
      {R"("steps": 10, "assertions": [{"quantity": "other_hash", "at_most": 0}])", "must have \"shapes\""},
      {R"("steps": 10, "assertions": [{"quantity": "other_hash", "at_most": 0, "shapes": [[0, 1]]}])",
       "[B, T]"},
      {R"("steps": 10, "limits": [{"why": "a"}])", "a limit must have a \"solver\""},
      {R"("steps": 10, "limits": [{"solver": "impulse"}])", "a limit must have a \"why\""},
      {R"("steps": 10, "executors": ["gpu"])", "\"cpu\" and \"cuda\""},
      {R"("steps": 10, "injected_faults": [{"fails": "speed", "step": 1, "body": 1}])",
       "\"assertions\" has none"},
      {R"("steps": 10, "injected_faults": [{"fails": "finite", "term": 2, "scene": "a.json"}])",
       "\"assertions\" has 1"},
      {R"("steps": 10, "injected_faults": [{"fails": "finite"}])", "a fault must have a \"set\" of settings"},
      {R"("steps": 10, "injected_faults": [{"step": 1, "body": 1}])", "a fault must have \"fails\""},
      {R"("steps": 10, "injected_faults": [{"fails": "finite", "step": 1, "body": 1, "position": [1, 2]}])",
       "a list of 3 numbers"},
      {R"("steps": 10, "injected_faults": [{"fails": "finite", "set": {"bodies": 3}}])", "one generator"},
      {R"("steps": 10, "run": {"key_bits": 31})", "\"key_bits\" must be 24, 30 or 63"},
      {R"("steps": 10, "assertion": [])", "did you mean \"assertions\"?"}};
  for (const auto& [members, words] : faults) {
    const std::string line = fault_of(members);
    EXPECT_THAT(line, testing::StartsWith("c:")) << members;
    EXPECT_THAT(line, HasSubstr(words)) << members;
  }
  EXPECT_THROW(parse_criterion("{}", "c", nullptr), InputError);
  EXPECT_THROW(parse_criterion("[]", "c", nullptr), InputError);
}

TEST(Criterion, EachQuantityHasAName) {
  for (std::size_t k = 0; k < quantity_names.size(); ++k)
    EXPECT_EQ(static_cast<std::size_t>(quantity_names[k].value), k);
  EXPECT_EQ(text_of(Quantity::speed, 0.012345), "0.0123 m/s");
  EXPECT_EQ(text_of(Quantity::touching, 9), "9");
}

}  // namespace
}  // namespace collidoscope
