// Tests hard cases in slices beside a running scene: their results, and opening the state at which a case
// failed.

#include "viewer/session/live_stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/hard_case_folder.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

struct Listed {
  void frame(double milliseconds = 5) {
    cases.follow(live.world(), requests);
    cases.advance(milliseconds);
  }
  const HardCasesView& to_the_end() {
    while (frame(), !cases.done()) ++frames;
    return cases.view();
  }
  std::size_t place(const std::string& name) {
    const auto& all = cases.view().cases;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all[k].name == name) return k;
    throw std::runtime_error("no case " + name);
  }
  std::vector<TestStatus> marks(const std::string& name) {
    std::vector<TestStatus> marks;
    for (const TestRunView& test_run : cases.view().cases[place(name)].test_runs)
      marks.push_back(test_run.status);
    return marks;
  }
  LiveStability::Opened open(const std::string& name, std::optional<std::size_t> test_run) {
    requests.open = HardCasesRequests::Opening{place(name), test_run};
    for (;;) {
      frame(0.01);
      if (auto opened = cases.take_opened()) return std::move(*opened);
      ++frames;
    }
  }

  HardCaseFolder folder;
  LiveWorld live{empty_space(), on_cpu(1)};
  LiveStability cases{folder.path(), on_cpu(1)};
  HardCasesRequests requests;
  int frames = 0;
};

TEST(LiveStability, MarksEachTrialOfEachCase) {
  Listed list;
  list.frame();
  EXPECT_EQ(list.cases.view().count(TestStatus::not_run), 5 * 6 + 1);
  list.requests.run_all = true;
  list.frame(0);
  EXPECT_FALSE(list.requests.run_all);
  EXPECT_EQ(list.cases.view().count(TestStatus::waiting), 5 * 6 + 1);
  EXPECT_NE(list.cases.view().current_task, "");
  const HardCasesView& view = list.to_the_end();
  EXPECT_EQ(view.current_task, "");
  using enum TestStatus;
  EXPECT_THAT(list.marks("flies"), testing::Each(passed));
  EXPECT_THAT(list.marks("falls"), testing::Each(failed));
  EXPECT_THAT(list.marks("turned"), testing::Each(passed));
  EXPECT_THAT(list.marks("wrong"), testing::ElementsAre(passed));
  EXPECT_THAT(list.marks("limited"),
              testing::ElementsAre(expected_failure, expected_failure, failed, failed, failed, failed));
  EXPECT_THAT(list.marks("rubs"),
              testing::ElementsAre(not_applicable, not_applicable, passed, passed, passed, passed));
  const TestRunView& fell = view.cases[list.place("falls")].test_runs[2];
  EXPECT_EQ(fell.solver, Solver::soft_step);
  EXPECT_EQ(fell.failed_state, 4);
  EXPECT_EQ(fell.body, 1u);
  EXPECT_THAT(fell.failure, testing::HasSubstr("position"));
  EXPECT_EQ(view.cases[list.place("limited")].test_runs[0].why, "as tests want it");
  EXPECT_NE(view.cases[list.place("rubs")].test_runs[0].why, "");
}

TEST(LiveStability, RunsOneAndStopsAndGoesOn) {
  Listed list;
  list.frame();
  list.requests.selected = "flies";
  list.requests.run_selected = true;
  list.to_the_end();
  EXPECT_EQ(list.cases.view().count(TestStatus::passed), 6);
  EXPECT_EQ(list.cases.view().count(TestStatus::not_run), 4 * 6 + 1);
  list.requests.run_all = true;
  list.frame(0);
  EXPECT_EQ(list.cases.view().count(TestStatus::passed), 6) << "what is known stays";
  list.requests.stop = true;
  list.frame(0);
  EXPECT_TRUE(list.cases.done());
  EXPECT_EQ(list.cases.view().count(TestStatus::waiting), 0);
  list.requests.run_all = true;
  list.to_the_end();
  EXPECT_EQ(list.cases.view().count(TestStatus::not_run), 0);
  list.requests.run_all = true;
  list.frame(0);
  EXPECT_EQ(list.cases.view().count(TestStatus::waiting), 5 * 6 + 1) << "all are known, so all again";
}

TEST(LiveStability, OpensACaseWhereItFailed) {
  Listed list;
  list.frame();
  list.requests.run_all = true;
  list.to_the_end();
  list.frames = 0;
  LiveStability::Opened opened = list.open("falls", 3);
  EXPECT_EQ(opened.world.steps(), 4);
  EXPECT_EQ(opened.world.scene().physics.solver, Solver::soft_step);
  EXPECT_EQ(opened.world.scene().physics.precision, Precision::f64);
  EXPECT_NEAR(opened.world.bodies().position[1].z(), 9.2, 1e-12);
  EXPECT_TRUE(opened.failed);
  EXPECT_EQ(opened.body, 1u);
  EXPECT_THAT(opened.notice, testing::HasSubstr("falls, soft_step f64: position"));
  EXPECT_EQ(list.cases.view().shown, list.place("falls"));
  EXPECT_EQ(list.cases.view().shown_test_run, 3u);

  LiveStability::Opened whole = list.open("falls", std::nullopt);
  EXPECT_EQ(whole.world.steps(), 0);
  EXPECT_FALSE(whole.failed);
  LiveStability::Opened passed = list.open("flies", 1);
  EXPECT_EQ(passed.world.steps(), 0);
  EXPECT_EQ(passed.world.scene().physics.precision, Precision::f64);
  list.requests.open = HardCasesRequests::Opening{list.place("wrong"), std::nullopt};
  list.frame();
  EXPECT_FALSE(list.cases.take_opened()) << "there is nothing to see";
}

TEST(LiveStability, AnOpenedCaseMakesItsChangesAndBeginsAgainWithThem) {
  Listed list;
  list.frame();
  LiveStability::Opened opened = list.open("turned", 2);
  EXPECT_EQ(opened.script.changes.size(), 1u);
  list.live.open(std::move(opened.world), std::move(opened.script));
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(list.live.world().steps(), 0);
    list.live.step(true);
    EXPECT_EQ(list.live.settings().physics.time_step, 0.1);
    list.live.step(true);
    EXPECT_EQ(list.live.settings().physics.time_step, 0.05);
    list.live.step(true);
    EXPECT_EQ(list.live.history().size(), 3u);
    list.live.restart();
  }
}

TEST(LiveStability, SaysWhatIsWrongWithAFolder) {
  TemporaryFolder empty;
  LiveWorld live(empty_space(), on_cpu(1));
  LiveStability cases(empty.path().string(), on_cpu(1));
  HardCasesRequests requests;
  requests.run_all = true;
  cases.follow(live.world(), requests);
  EXPECT_THAT(cases.view().unavailable_reason, testing::HasSubstr("contains no case"));
  EXPECT_TRUE(cases.done());
}

}  // namespace
}  // namespace collidoscope
