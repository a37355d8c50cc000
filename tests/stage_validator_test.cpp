// Tests the checks of guards after each stage: faults injected into the stage's output, on each executor.

#include "sim_cuda/guard/stage_validator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/executors.h"

namespace collidoscope {
namespace {

constexpr std::size_t n = 5;

/// Five valid bodies with boxes, one contact and an acceleration each. The stages only do what a test
/// specifies.
template <class Real>
class Stages {
 public:
  using Vector = Vector3<Real>;

  explicit Stages(const RunOptions& options, const ValidationSettings& guards = {})
      : executor_(options), validator_(executor_, guards) {
    bodies.position.upload(std::vector<Vector>(n, Vector(1, 2, 3)));
    bodies.velocity.upload(std::vector<PackedVector3<Real>>(n, Vector(0, 4, 3)));
    bodies.orientation.upload(std::vector<Quaternion<Real>>(n, Quaternion<Real>(1, 0, 0, 0)));
    bodies.angular_velocity.upload(std::vector<PackedVector3<Real>>(n, Vector(0, 0, 7)));
    boxes.upload(std::vector<Aabb>(n, Aabb{{0, 1, 2}, {2, 3, 4}}));
    field.upload(std::vector<Vector>(n, Vector(0, 0, -1)));
    contacts.upload({Pair{1, 2}, Pair{3, 4}});
    normals.upload({Vector(0, 0, 1), Vector(0, 1, 0)});
    StepControl counts{};
    counts.contacts = 2;
    control.upload({counts});
  }

  /// A stage that overwrites a value with the bytes of a NaN.
  struct Spoilt {
    const char* stage;
    void* value = nullptr;  ///< null: no change
    int substep = 0;
  };
  void run(const std::vector<Spoilt>& stages) {
    validator_.run_validated(
        {bodies.view(), n, boxes.data(), field.data(), {contacts.data(), normals.data()}, 2, control.data()},
        [&] {
          for (const Spoilt& each : stages) {
            executor_.begin_substep(each.substep);
            executor_.begin_stage(each.stage);
            if (each.value != nullptr) executor_.fill(each.value, 0xff, sizeof(Real));
          }
        });
  }
  FirstViolation found() const { return validator_.first_violation(); }
  Finding read(const std::vector<Spoilt>& stages) {
    validator_.describe(validator_.first_violation());
    run(stages);
    return validator_.finding();
  }

 private:
  Executor executor_;

 public:
  BodyBuffers<Real> bodies{executor_};
  Buffer<Aabb> boxes{executor_, "boxes"};
  Buffer<Vector> field{executor_, "field"}, normals{executor_, "normals"};
  Buffer<Pair> contacts{executor_, "contacts"};
  Buffer<StepControl> control{executor_, "control"};

 private:
  StageValidator<Real> validator_;
};

class StageValidators : public OnEachExecutor {};
ON_EACH_EXECUTOR(StageValidators);

template <class Real>
void find_each(const RunOptions& options) {
  Stages<Real> probe(options);
  struct Planted {
    const char* stage;
    FindingQuantity quantity;
  };
  for (const Planted& planted :
       std::initializer_list<Planted>{{"bounds", FindingQuantity::box},
                                      {"contacts", FindingQuantity::normal},
                                      {"attractor", FindingQuantity::acceleration},
                                      {"islands", FindingQuantity::velocity},
                                      {"prescribe", FindingQuantity::position},
                                      {"prescribe", FindingQuantity::velocity},
                                      {"integrate", FindingQuantity::velocity},
                                      {"forces", FindingQuantity::velocity},
                                      {"forces", FindingQuantity::spin},
                                      {"drag", FindingQuantity::velocity},
                                      {"joints", FindingQuantity::velocity},
                                      {"joints", FindingQuantity::spin},
                                      {"solve", FindingQuantity::velocity},
                                      {"solve", FindingQuantity::spin},
                                      {"solve", FindingQuantity::position},
                                      {"walls", FindingQuantity::velocity},
                                      {"walls", FindingQuantity::position},
                                      {"relax", FindingQuantity::velocity},
                                      {"relax", FindingQuantity::spin},
                                      {"bounce", FindingQuantity::velocity},
                                      {"bounce", FindingQuantity::spin},
                                      {"move", FindingQuantity::position},
                                      {"move", FindingQuantity::orientation},
                                      {"turn", FindingQuantity::orientation},
                                      {"turn", FindingQuantity::spin},
                                      {"a stage to come", FindingQuantity::position}}) {
    Stages<Real> stages(options);
    const auto place = [&]() -> void* {
      switch (planted.quantity) {
        case FindingQuantity::box:
          return &stages.boxes.data()[3].max;
        case FindingQuantity::normal:
          return &stages.normals.data()[1];
        case FindingQuantity::acceleration:
          return &stages.field.data()[3];
        case FindingQuantity::velocity:
          return &stages.bodies.velocity.data()[3];
        case FindingQuantity::spin:
          return &stages.bodies.angular_velocity.data()[3];
        case FindingQuantity::position:
          return &stages.bodies.position.data()[3];
        case FindingQuantity::orientation:
          return &stages.bodies.orientation.data()[3];
      }
      return nullptr;
    };
    const std::vector<typename Stages<Real>::Spoilt> run{
        {"bounds"}, {"keys"}, {"contacts"}, {planted.stage, place(), 2}, {"keep"}, {"later"}};
    // A stage after one of the same name counts as the same stage.
    stages.run(run);
    const FirstViolation found = stages.found();
    const std::string what = std::string(planted.stage) + ", " + std::string(name_of(planted.quantity));
    ASSERT_NE(found.key, FirstViolation::none) << what;
    EXPECT_EQ(found.body(), 3u) << what;
    EXPECT_EQ(found.is_final, 1u) << what;
    const Finding finding = stages.read(run);
    EXPECT_EQ(finding.stage, planted.stage) << what;
    EXPECT_EQ(finding.quantity, planted.quantity) << what;
    EXPECT_EQ(finding.body, 3u) << what;
    EXPECT_FALSE(std::isfinite(finding.value)) << what;
    if (std::string_view(planted.stage) != "contacts") {
      EXPECT_EQ(finding.substep, 3) << what;
    }
  }
}

TEST_P(StageValidators, FindAFaultInWhatEachStageWrites) {
  find_each<float>(options());
  find_each<double>(options());
}

TEST_P(StageValidators, AreQuietWhereAllIsWell) {
  Stages<float> stages(options());
  stages.run({{"bounds"}, {"contacts"}, {"attractor"}, {"forces"}, {"move"}});
  EXPECT_EQ(stages.found().key, FirstViolation::none);
  EXPECT_EQ(stages.found().is_final, 0u);
}

TEST_P(StageValidators, KeepTheFirstStageAndItsLowestBody) {
  Stages<float> stages(options());
  // Stage "keys" has no checks. Its fault is found after the next stage that may have written the value.
  stages.run({{"bounds"},
              {"keys", &stages.bodies.velocity.data()[4]},
              {"forces", &stages.bodies.velocity.data()[2]},
              {"solve", &stages.bodies.velocity.data()[0]}});
  EXPECT_EQ(stages.found().stage(), 2u);
  EXPECT_EQ(stages.found().body(), 2u);
  // A fault in a later run of the stages does not replace the first one, even in an earlier stage.
  stages.run({{"bounds", &stages.boxes.data()[1]}});
  EXPECT_EQ(stages.found().stage(), 2u);
  EXPECT_EQ(stages.found().body(), 2u);
}

TEST_P(StageValidators, LookAtBoxesAloneInARunThatAnOverflowStopped) {
  Stages<float> stages(options());
  StepControl control{};
  control.overflow = 1;
  stages.control.upload({control});
  stages.run({{"bounds"}, {"forces", &stages.bodies.velocity.data()[2]}});
  EXPECT_EQ(stages.found().key, FirstViolation::none);
  stages.run({{"bounds", &stages.boxes.data()[4]}, {"forces"}});
  EXPECT_EQ(stages.found().body(), 4u);
  EXPECT_EQ(stages.found().is_final, 0u) << "the run will be done again";
}

TEST_P(StageValidators, TakeForAbsurdWhatIsBeyondTheLimitsAlone) {
  ValidationSettings guards;
  guards.speed = 5;          // equal to the speed of the bodies
  guards.angular_speed = 7;  // equal to their angular speed
  guards.distance = 4;       // equal to the extent of their boxes
  const auto finds = [&](const ValidationSettings& limits) {
    Stages<double> stages(options(), limits);
    stages.run({{"bounds"}, {"move"}});
    return stages.found().key != FirstViolation::none;
  };
  EXPECT_FALSE(finds(guards));
  const auto below = [](double x) { return std::nextafter(x, 0); };
  for (double ValidationSettings::*limit :
       {&ValidationSettings::speed, &ValidationSettings::angular_speed, &ValidationSettings::distance}) {
    ValidationSettings narrow = guards;
    narrow.*limit = limit == &ValidationSettings::distance ? 3.99 : below(guards.*limit);
    EXPECT_TRUE(finds(narrow)) << narrow.*limit;
  }
  // In both precisions, a value whose square overflows is beyond every limit.
  Stages<float> fast(options());
  fast.bodies.velocity.upload(std::vector<PackedVector3<float>>(n, Vector3f(0, 1e30f, 0)));
  fast.run({{"forces"}});
  EXPECT_EQ(fast.found().body(), 0u);
  EXPECT_EQ(fast.read({{"forces"}}).value, static_cast<double>(1e30f));
}

}  // namespace
}  // namespace collidoscope
