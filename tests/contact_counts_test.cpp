// Tests the two contact counts: touching pairs in a state, against brute force, and the last step's contacts
// including speculative ones.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "sim_cuda/narrow_phase/sphere_sphere.h"
#include "sim_cuda/scene/names.h"
#include "tests/executors.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

template <class Real>
std::int64_t touching_pairs(const std::vector<Vector3d>& position, const std::vector<double>& radius) {
  const auto touch = [&](std::size_t i, std::size_t j) {
    return spheres_touch<Real>(position[i].cast<Real>(), static_cast<Real>(radius[i]),
                               position[j].cast<Real>(), static_cast<Real>(radius[j]));
  };
  std::int64_t count = 0;
  for (std::size_t i = 0; i < position.size(); ++i)
    for (std::size_t j = i + 1; j < position.size(); ++j) count += touch(i, j);
  return count;
}

std::int64_t touching_pairs(World& world) {
  const auto count =
      world.scene().physics.precision == Precision::f64 ? touching_pairs<double> : touching_pairs<float>;
  return count(world.bodies().position, world.initial().radius);
}

class ContactCounts : public OnEachExecutor {};
ON_EACH_EXECUTOR(ContactCounts);

TEST_P(ContactCounts, OfTouchingPairsAreThoseOfBruteForceInEachState) {
  std::int64_t seen = 0;
  for (const Solver solver : {Solver::impulse, Solver::soft_step, Solver::jacobi_split})
    for (const Precision precision : {Precision::f32, Precision::f64})
      for (const Variant variant : {Variant::paper, Variant::scaled}) {
        Scene scene = box_collider(600, variant);
        scene.physics.solver = solver;
        scene.physics.precision = precision;
        scene.physics.substeps = 2;
        World world(scene, options());
        for (int k = 0; k < 12; ++k) {
          const StepStats stats = world.measure();
          ASSERT_EQ(stats.touching, touching_pairs(world))
              << name_of(solver_names, solver) << ' ' << name_of(precision_names, precision) << " state "
              << stats.step;
          seen += stats.touching;
          world.step(7);
        }
      }
  EXPECT_GT(seen, 5000);
}

TEST_P(ContactCounts, OfPairsThatShareOnePoint) {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Scene scene = empty_space();
    scene.physics.precision = precision;
    // Two touching pairs, and a gap of one float unit in the last place.
    scene.bodies = {sphere(1, Vector3d(0, 0, 0)), sphere(1, Vector3d(2, 0, 0)), sphere(1, Vector3d(2, 2, 0)),
                    sphere(1, Vector3d(0, 0, std::nextafter(2.0f, 3.0f)))};
    World world(scene, options());
    EXPECT_EQ(world.measure().touching, 2);
    world.step(3);
    EXPECT_EQ(world.measure().touching, 2);
  }
}

// A ball flies past a row of others within one step. The step must test all of them; it touches none.
TEST_P(ContactCounts, OfWhatAStepForesawAreApartFromTouching) {
  Scene scene = hard_space();
  scene.physics.time_step = 0.1;
  for (int k = 0; k < 5; ++k) scene.bodies.push_back(sphere(0.5, Vector3d(2 * k, 1.1, 0)));
  scene.bodies.push_back(sphere(0.5, Vector3d(-2, 0, 0), Vector3d(150, 0, 0)));
  World world(scene, options());
  EXPECT_EQ(world.measure().touching, 0);
  EXPECT_EQ(world.measure().speculative, 0) << "no step yet";
  world.step();
  EXPECT_EQ(world.measure().touching, 0);
  EXPECT_EQ(world.measure().speculative, 5);
  scene.physics.solver = Solver::impulse;
  World impulse(scene, options());
  impulse.step();
  EXPECT_EQ(impulse.measure().speculative, 0) << "impulse has no margin";
}

// Publishes the counts without a previous measurement.
TEST_P(ContactCounts, OfWhatIsDrawnAreThoseThatTouch) {
  Scene scene = box_collider(600);
  scene.physics.solver = Solver::soft_step;
  World world(scene, options());
  world.step(30);
  const std::int64_t drawn = world.publisher().counts(0, -1).contacts;
  EXPECT_EQ(drawn, touching_pairs(world));
  EXPECT_GT(world.measure().speculative, drawn);
}

TEST(ContactCountsReported, AreWhatTheDumpedBodiesSay) {
  const TemporaryFolder folder;
  const std::string bodies = folder / "bodies.csv", json = folder / "run.json";
  const Outcome outcome = run_headless({"run", "box_collider", "--bodies", "2000", "--steps", "60",
                                        "--executor", "cpu", "--dump-bodies", bodies, "--json", json});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::vector<Vector3d> position;
  std::vector<double> radius;
  std::istringstream lines(text_of(bodies));
  std::string line;
  std::getline(lines, line);
  ASSERT_EQ(line, "id,radius,mass,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz");
  while (std::getline(lines, line)) {
    double id, r, mass, x, y, z;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf", &id, &r, &mass, &x, &y, &z), 6);
    position.emplace_back(x, y, z);
    radius.push_back(r);
  }
  ASSERT_EQ(position.size(), 2000u);
  const std::int64_t touching = touching_pairs<float>(position, radius);
  const nlohmann::json pairs = nlohmann::json::parse(text_of(json)).at("pairs");
  EXPECT_GT(touching, 20);
  EXPECT_EQ(pairs.at("contacts"), touching);
  EXPECT_EQ(pairs.at("touching"), touching);
  EXPECT_GT(pairs.at("speculative").get<std::int64_t>(), 2 * touching);
  EXPECT_LE(pairs.at("speculative").get<std::int64_t>(), pairs.at("aabb").get<std::int64_t>());
  EXPECT_THAT(outcome.out, testing::HasSubstr("; " + std::to_string(touching) + " touching\n"));
}

}  // namespace
}  // namespace collidoscope
