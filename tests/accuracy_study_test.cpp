// Tests the accuracy study on scenes with closed-form errors. Also tests that an interrupted study continues
// from its record.

#include "sim_cuda/accuracy/study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/accuracy/errors.h"
#include "sim_cuda/accuracy/settings.h"
#include "sim_cuda/core/error.h"
#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class AccuracyStudyOn : public OnEachExecutor {};
ON_EACH_EXECUTOR(AccuracyStudyOn);

/// A single ball thrown upwards.
Scene thrown() {
  Scene scene = hard_space(Vector3d(0, 0, -9.81));
  scene.physics.substeps = 1;
  scene.bodies.push_back(sphere(1, Vector3d(0, 0, 0), Vector3d(3, 0, 20)));
  return scene;
}

AccuracyPoint setting(const std::string& name, AccuracySetting values) {
  AccuracyPoint point;
  point.series_name = "test";
  point.name = name;
  point.setting = values;
  return point;
}

std::vector<AccuracyPoint> steps(const Scene& scene, std::initializer_list<int> parts) {
  std::vector<AccuracyPoint> points;
  for (const int part : parts)
    points.push_back(
        setting(std::to_string(part),
                {.time_step = scene.physics.time_step / part, .substeps = 1, .precision = Precision::f64}));
  return points;
}

void finish(AccuracyStudy& study) {
  while (study.advance(1000)) {
  }
}

const AccuracyPoint* find(const AccuracyStudy& study, const std::string& series_name,
                          const std::string& name) {
  for (const AccuracyPoint& point : study.points())
    if (point.series_name == series_name && point.name == name) return &point;
  return nullptr;
}

TEST_P(AccuracyStudyOn, FindsTheBiasOfEulerInFreeFlight) {
  const Scene scene = thrown();
  AccuracyStudy study(scene, options(),
                      {.seconds = 1, .rounds = 2, .settings = steps(scene, {1, 2, 4, 8, 16})});
  finish(study);
  ASSERT_NE(study.reference(), nullptr);
  EXPECT_EQ(study.reference()->kind, AccuracyReference::Kind::hard_spheres);
  EXPECT_EQ(study.reference()->end, "");
  EXPECT_LT(study.reference()->error, 1e-12);
  std::vector<double> h, errors;
  for (const AccuracyPoint& p : study.points()) {
    // The position lags by g h t / 2 at time t. This is the r.m.s. over the samples.
    double square = 0;
    const int samples = study.problem().samples;
    for (int k = 1; k <= samples; ++k) square += std::pow(study.problem().time(k), 2) / samples;
    EXPECT_NEAR(p.error, 9.81 * p.setting.time_step / 2 * std::sqrt(square), 1e-9) << p.name;
    EXPECT_NEAR(p.error_worst, 9.81 * p.setting.time_step / 2 * study.problem().time(samples), 1e-9);
    EXPECT_EQ(p.error_low, p.error);  // the scene has one body
    EXPECT_LT(p.invariants.momentum_balance, 1e-12);
    EXPECT_EQ(p.invariants.penetration_max, 0);
    EXPECT_GT(p.ms.median, 0);
    EXPECT_EQ(p.ms_runs.size(), 2u);
    EXPECT_LE(p.ms.low, p.ms.median);
    EXPECT_GE(p.ms.high, p.ms.median);
    h.push_back(p.setting.time_step);
    errors.push_back(p.error);
  }
  EXPECT_NEAR(fitted_order(h, errors), 1, 1e-6);
  EXPECT_TRUE(study.warnings().empty());
  EXPECT_TRUE(study.points().back().on_front);  // the smallest step has the smallest error
}

TEST(AccuracyStudy, NoticesAWrongReference) {
  const Scene scene = thrown();
  Scene wrong = scene;
  wrong.physics.gravity = Vector3d(0, 0, -9.7);
  const AccuracyStudyOptions request{.seconds = 1, .rounds = 1, .settings = steps(scene, {16, 32, 64})};
  AccuracyStudyOptions reference_scene = request;
  reference_scene.reference_scene = wrong;
  AccuracyStudy honest(scene, {}, request), deceived(scene, {}, reference_scene);
  finish(honest);
  finish(deceived);
  EXPECT_TRUE(honest.warnings().empty());
  ASSERT_EQ(deceived.warnings().size(), 1u);
  EXPECT_NE(deceived.warnings()[0].find("converges to another solution"), std::string::npos);
}

TEST(AccuracyStudy, TakesAConvergedRunWhereNothingExactIsKnown) {
  // A pendulum: a rod fixed to the world. The method has order 2 or more, and the period is known.
  Scene scene = hard_space(Vector3d(0, 0, -9.81));
  scene.bodies.push_back(sphere(0.1, Vector3d(1, 0, 0)));
  Joint rod;
  rod.kind = JointKind::distance;
  rod.anchor_b = Vector3d(0, 0, 0);
  scene.joints.push_back(rod);
  AccuracyStudy study(scene, {}, {.seconds = 0.6, .rounds = 1, .settings = steps(scene, {1, 2, 4})});
  finish(study);
  const AccuracyReference& reference = *study.reference();
  EXPECT_EQ(reference.kind, AccuracyReference::Kind::converged_run);
  EXPECT_NEAR(reference.horizon, reference.seconds, 1e-9);
  EXPECT_GT(reference.order, 0.85);
  // The body swings from the horizontal to the other side. It is at the lowest point after 1.8541 sqrt(l/g).
  const double quarter = 1.8540746773013719 * std::sqrt(1 / 9.81);
  const int samples = study.problem().samples;
  for (int k = 1; k <= samples; ++k) {
    const Vector3d& x = study.samples()[static_cast<std::size_t>(k)].bodies.position[0];
    EXPECT_EQ(x.x() > 0, study.problem().time(k) < quarter) << study.problem().time(k);
    EXPECT_NEAR(x.norm(), 1, 1e-4);
  }
  EXPECT_LT(reference.error, 1e-2 * study.points().front().error);
  for (std::size_t k = 1; k < study.points().size(); ++k)
    EXPECT_LT(study.points()[k].error, study.points()[k - 1].error);
}

TEST(AccuracyStudy, GoesNoFurtherThanPositionsMeanAnything) {
  // Spheres in a box: each collision amplifies a displacement.
  Scene scene = hard_space(Vector3d(0, 0, 0));
  scene.box = Box{Vector3d(0, 0, 0), Vector3d(10, 10, 10)};
  scene.generators = {{.count = 15, .radius_max = 2, .spawn = Spawn::apart, .speed_max = 10}};
  AccuracyStudy study(scene, {}, {.seconds = 8, .rounds = 1, .settings = steps(scene, {16})});
  finish(study);
  const AccuracyReference& reference = *study.reference();
  EXPECT_EQ(reference.kind, AccuracyReference::Kind::hard_spheres);
  EXPECT_NEAR(reference.seconds, 8, 1e-9);
  EXPECT_LT(reference.horizon, 4);
  EXPECT_GT(reference.lyapunov_rate, 1);
  EXPECT_NE(reference.end.find("a small perturbation has grown"), std::string::npos);
  // The energy error is measured up to the end of the run.
  EXPECT_LT(study.points()[0].invariants.energy_error, 0.2);
  EXPECT_GT(study.points()[0].distributions.speeds, 0);
}

TEST(AccuracyStudy, EndsAtAZenoPointOrGoesRoundIt) {
  // Restitution 0.5 and a drop from 1 m: the ball rests after 3 sqrt(2 h/g).
  Scene scene = hard_space(Vector3d(0, 0, -9.81), 0.5);
  scene.obstacles.push_back({});
  scene.bodies.push_back(sphere(0.5, Vector3d(0, 0, 1.5)));
  const double rest = 3 * std::sqrt(2 / 9.81);
  AccuracyStudy shorter(scene, {}, {.seconds = 1.6, .rounds = 1, .settings = steps(scene, {4})});
  finish(shorter);
  EXPECT_EQ(shorter.reference()->kind, AccuracyReference::Kind::hard_spheres);
  EXPECT_LT(shorter.reference()->seconds, rest);
  EXPECT_NE(shorter.reference()->end.find("Zeno point at 1.35"), std::string::npos);
  AccuracyStudy longer(scene, {}, {.seconds = 5, .rounds = 1, .settings = steps(scene, {4})});
  finish(longer);
  EXPECT_EQ(longer.reference()->kind, AccuracyReference::Kind::converged_run);
  EXPECT_NE(longer.reference()->description.find("Zeno point"), std::string::npos);
}

TEST(AccuracyStudy, GoesOnWhereItWasCutShort) {
  const Scene scene = thrown();
  const AccuracyStudyOptions request{.seconds = 1, .rounds = 2, .settings = steps(scene, {1, 2, 4, 8})};
  AccuracyStudy whole(scene, {}, request), first(scene, {}, request), second(scene, {}, request);
  finish(whole);
  while (first.points().empty() || first.progress().done < 5) first.advance(0);
  const AccuracyRecord kept = parse_record(write_record(first.record()), "test");
  EXPECT_FALSE(kept.complete);
  ASSERT_TRUE(second.restore(kept));
  finish(second);
  EXPECT_LT(second.progress().total, whole.progress().total);
  ASSERT_EQ(second.points().size(), whole.points().size());
  for (std::size_t k = 0; k < whole.points().size(); ++k) {
    const AccuracyPoint &a = whole.points()[k], &b = second.points()[k];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.error, b.error);
    EXPECT_EQ(a.invariants.energy_error, b.invariants.energy_error);
    EXPECT_EQ(b.ms_runs.size(), 2u);
    if (!kept.points[k].ms_runs.empty()) {
      EXPECT_EQ(b.ms_runs[0], kept.points[k].ms_runs[0]);
    }
  }
  EXPECT_TRUE(second.record().complete);
  // A record of another scene, another length or another physics version is rejected.
  Scene other = scene;
  other.bodies[0].velocity.x() = 4;
  EXPECT_FALSE(AccuracyStudy(other, {}, request).restore(kept));
  AccuracyRecord older = kept;
  older.physics_version = 1;
  EXPECT_FALSE(AccuracyStudy(scene, {}, request).restore(older));
  AccuracyStudyOptions longer = request;
  longer.seconds = 2;
  EXPECT_FALSE(AccuracyStudy(scene, {}, longer).restore(kept));
}

TEST(AccuracyStudy, StartsWhereARunStands) {
  const Scene scene = thrown();
  World world(scene, {});
  world.step(30);
  const RunState state = world.state();
  AccuracyStudy study(scene, {}, {.seconds = 0.5, .rounds = 1, .settings = steps(scene, {1})}, &state);
  finish(study);
  EXPECT_EQ(study.samples()[0].bodies.position, state.bodies.position);
  EXPECT_EQ(study.problem().start.steps, 0);
}

TEST(AccuracyStudy, TriesEveryFamilyThatTheSceneCanTake) {
  Scene scene = box_collider(20);
  scene.physics.solver = Solver::soft_step;
  scene.generators[0].spawn = Spawn::apart;
  AccuracyStudy study(scene, {}, {.seconds = 0.2, .rounds = 1});
  finish(study);
  for (const char* series_name : {"soft_step f32", "soft_step f64", "impulse f32", "jacobi_split f64"})
    EXPECT_TRUE(std::ranges::any_of(study.points(), [&](const auto& p) {
      return p.series_name == series_name;
    })) << series_name;
  for (const AccuracyPoint& p : study.points()) {
    EXPECT_TRUE(p.has_error() && p.has_cost()) << p.series_name << p.name;
    EXPECT_GT(p.error, 0);
  }
  EXPECT_NE(find(study, "soft_step f32", "1/30 s, 4 substeps"), nullptr);
  // The solver `impulse` has no friction.
  scene.materials[0].friction = 0.5;
  AccuracyStudy rubbing(scene, {}, {.seconds = 0.2, .rounds = 1});
  while (rubbing.points().empty()) rubbing.advance(100);
  for (const AccuracyPoint& p : rubbing.points()) EXPECT_NE(p.setting.solver, Solver::impulse);
}

TEST(AccuracyStudy, RefusesASceneInWhichNothingMoves) {
  Scene scene = hard_space();
  EXPECT_THROW(AccuracyStudy(scene, {}), InputError);
  scene.bodies.push_back(sphere(1, Vector3d(0, 0, 0)));
  scene.bodies[0].motion = Motion::fixed;
  EXPECT_THROW(AccuracyStudy(scene, {}), InputError);
}

}  // namespace
}  // namespace collidoscope
