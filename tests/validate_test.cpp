// Tests validate(): each range at both ends, on structs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

using testing::StartsWith;
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

/// A valid scene with one element of each kind.
Scene full_scene() {
  Scene scene;
  scene.physics.solver = Solver::impulse;
  scene.box = Box{};
  scene.materials.push_back({.name = "steel", .density = 7850});
  scene.bodies.resize(2);
  scene.bodies[1].inertia = Vector3d(1, 2, 3);
  scene.bodies[1].mass = 2;
  scene.generators.push_back({});
  scene.obstacles.push_back({});
  scene.camera.position = Vector3d(100, 0, 0);
  scene.camera.target = Vector3d(0, 0, 0);
  scene.physics.restitution_threshold = 0.5;
  return scene;
}

/// Adds an attractor, and selects a solver that supports it.
std::vector<Attractor>& pulling(Scene& scene) {
  scene.physics.solver = Solver::soft_step;
  scene.physics.attractors = {{.strength = 10}};
  return scene.physics.attractors;
}

/// Adds boxes, and selects a solver that supports them.
std::vector<BoxObstacle>& boxes(Scene& scene) {
  scene.physics.solver = Solver::soft_step;
  scene.boxes.resize(2);
  return scene.boxes;
}

TEST(Validate, AcceptsWhatIsValid) {
  EXPECT_TRUE(validate(Scene{}).empty());
  EXPECT_TRUE(validate(full_scene()).empty());
}

struct Case {
  std::string path, message;
  std::function<void(Scene&)> change;
};

TEST(Validate, NamesEveryFault) {
  const std::vector<Case> cases = {
      {"name", "must be UTF-8", [](Scene& s) { s.name = "a\nb"; }},
      {"name", "must be UTF-8", [](Scene& s) { s.name = std::string(201, 'a'); }},
      {"name", "must be UTF-8", [](Scene& s) { s.name = "\xFF"; }},
      {"box.min[1]", "must lie in [-1e+09, 1e+09] m", [](Scene& s) { s.box->min[1] = -1e10; }},
      {"box.max[2]", "must lie in", [](Scene& s) { s.box->max[2] = nan_value; }},
      {"box.max[0]", "must be more than min[0] = 0", [](Scene& s) { s.box->max[0] = 0; }},
      {"box.max[0]", "must be more than min[0] = 100000000",
       [](Scene& s) {
         s.box->min[0] = 1e8;
         s.box->max[0] = 1e8 + 1;  // one float
       }},
      {"gravity[2]", "must lie in [-1e+06, 1e+06] m/s^2", [](Scene& s) { s.physics.gravity[2] = -infinite; }},
      {"gravity[0]", "must be 0 or at least", [](Scene& s) { s.physics.gravity[0] = 1e-39; }},
      {"drag.viscosity", "must lie in [0, 1e+09] Pa s", [](Scene& s) { s.physics.drag.viscosity = -1; }},
      {"drag.density", "must lie in [0, 1e+09] kg/m^3", [](Scene& s) { s.physics.drag.density = nan_value; }},
      {"drag.coefficient", "must lie in [0, 100]", [](Scene& s) { s.physics.drag.coefficient = 101; }},
      {"attractors", "must not contain attractors with the solver impulse (use soft_step)",
       [](Scene& s) { s.physics.attractors.resize(1); }},
      {"effects", "must not contain attractors with the solver impulse (use soft_step)",
       [](Scene& s) { s.physics.effects = Effects{.attractor = true}; }},
      {"effects", "must not contain continuous_collision with the solver impulse (use soft_step)",
       [](Scene& s) { s.physics.effects = Effects{.continuous_collision = true}; }},
      {"attractors", "must be at most 1000 attractors", [](Scene& s) { pulling(s).resize(1001); }},
      {"attractors[0].position[1]", "must lie in [-1e+09, 1e+09] m",
       [](Scene& s) { pulling(s)[0].position[1] = 2e9; }},
      {"attractors[0].strength", "must lie in [-1e+24, 1e+24] m^3/s^2",
       [](Scene& s) { pulling(s)[0].strength = infinite; }},
      {"attractors[0].softening", "must lie in [0.001, 1e+09] m",
       [](Scene& s) { pulling(s)[0].softening = 0; }},
      {"attractors[0].softening", "must be larger: the acceleration would reach 3.85e+06 m/s^2, above 1e+06",
       [](Scene& s) { pulling(s)[0] = {.strength = -1e7, .softening = 1}; }},
      {"time_step", "must lie in [1e-09, 1000] s", [](Scene& s) { s.physics.time_step = 0; }},
      {"time_step", "must lie in", [](Scene& s) { s.physics.time_step = nan_value; }},
      {"steps_per_second", "must be a whole number from 1 to 1000000",
       [](Scene& s) { s.physics.time_step = TimeStep::per_second(0); }},
      {"substeps", "must be a whole number from 1 to 1000", [](Scene& s) { s.physics.substeps = 0; }},
      {"iterations", "must be a whole number from 1 to 1000", [](Scene& s) { s.physics.iterations = 1001; }},
      {"solver", "must be impulse, soft_step or jacobi_split",
       [](Scene& s) { s.physics.solver = static_cast<Solver>(7); }},
      {"integrator", "must be", [](Scene& s) { s.physics.integrator = static_cast<Integrator>(7); }},
      {"rotation_update", "must be first_order or lie_group",
       [](Scene& s) { s.physics.rotation_update = static_cast<RotationUpdate>(7); }},
      {"precision", "must be f32 or f64", [](Scene& s) { s.physics.precision = static_cast<Precision>(7); }},
      {"restitution_threshold", "must lie in [0, 1e+09] m/s",
       [](Scene& s) { s.physics.restitution_threshold = -1; }},
      {"materials", "must start with", [](Scene& s) { s.materials.erase(s.materials.begin()); }},
      {"materials", "must start with",
       [](Scene& s) {
         s = Scene{};
         s.materials.clear();
       }},
      {"materials.steel.density", "must lie in [1e-09, 1e+18] kg/m^3",
       [](Scene& s) { s.materials[1].density = 0; }},
      {"materials.default.restitution", "must lie in [0, 1]",
       [](Scene& s) { s.materials[0].restitution = 1.1; }},
      {"materials.steel.friction", "must be 0 with the solver impulse",
       [](Scene& s) { s.materials[1].friction = 0.3; }},
      {"materials.steel.friction", "must lie in [0, 100]",
       [](Scene& s) { s.materials[1].friction = nan_value; }},
      {"materials.steel.rolling_resistance", "must be 0 with the solver impulse",
       [](Scene& s) { s.materials[1].rolling_resistance = 0.1; }},
      {"materials.steel.rolling_resistance", "must lie in [0, 10]",
       [](Scene& s) { s.materials[1].rolling_resistance = -1; }},
      {"materials[\"a b\"].density", "must lie in",
       [](Scene& s) {
         s.materials[1].name = "a b";
         s.materials[1].density = -1;
       }},
      {"materials[\"\"]", "a material's name must be", [](Scene& s) { s.materials[1].name = ""; }},
      {"materials[\"a\"b\"]", "a material's name must be", [](Scene& s) { s.materials[1].name = "a\"b"; }},
      {"materials.default", "two materials must not have the same name",
       [](Scene& s) { s.materials[1].name = "default"; }},
      {"bodies[1].radius", "must lie in [1e-09, 1e+09] m", [](Scene& s) { s.bodies[1].radius = 0; }},
      {"bodies[1].radius", "must lie in", [](Scene& s) { s.bodies[1].radius = -1; }},
      {"bodies[0].radius", "must be at most 50 m, for the sphere to fit in the box",
       [](Scene& s) { s.bodies[0].radius = 51; }},
      {"bodies[0].mesh", "must name an OBJ file", [](Scene& s) { s.bodies[0].shape = Shape::mesh; }},
      {"bodies[0].shape", "must be sphere or mesh",
       [](Scene& s) {
         s.bodies[0].shape = static_cast<Shape>(9);
         s.bodies[0].mesh = "a.obj";
       }},
      {"bodies[1].motion", "must be dynamic, kinematic or static",
       [](Scene& s) { s.bodies[1].motion = static_cast<Motion>(9); }},
      {"bodies[1].motion", "must be kinematic or dynamic if a velocity is given",
       [](Scene& s) {
         s.bodies[1].motion = Motion::fixed;
         s.bodies[1].angular_velocity.x() = 1;
       }},
      {"bodies[1].position[0]", "must lie in", [](Scene& s) { s.bodies[1].position[0] = infinite; }},
      {"bodies[1].orientation", "must be a quaternion of length 1",
       [](Scene& s) { s.bodies[1].orientation = Quaterniond(1, 1, 0, 0); }},
      {"bodies[1].orientation", "must be a quaternion",
       [](Scene& s) { s.bodies[1].orientation = Quaterniond(nan_value, 1, 0, 0); }},
      {"bodies[1].velocity[2]", "must lie in [-1e+09, 1e+09] m/s",
       [](Scene& s) { s.bodies[1].velocity[2] = 2e9; }},
      {"bodies[1].angular_velocity[2]", "must lie in [-1e+09, 1e+09] rad/s",
       [](Scene& s) { s.bodies[1].angular_velocity[2] = 2e9; }},
      {"bodies[1].mass", "must lie in [1e-30, 1e+30] kg", [](Scene& s) { s.bodies[1].mass = 0; }},
      {"bodies[1].inertia[0]", "must lie in [1e-36, 1e+36] kg m^2",
       [](Scene& s) { s.bodies[1].inertia->x() = 0; }},
      {"bodies[1].inertia[2]", "must not exceed the sum", [](Scene& s) { s.bodies[1].inertia->z() = 3.1; }},
      {"bodies[1].material", "must be the index", [](Scene& s) { s.bodies[1].material = 2; }},
      {"bodies[1].material", "must be the index", [](Scene& s) { s.bodies[1].material = -1; }},
      {"generators[0].count", "must be a whole number from 0 to 134217728",
       [](Scene& s) { s.generators[0].count = 10'000'000'000; }},
      {"generators[0].count", "must be a whole number", [](Scene& s) { s.generators[0].count = -1; }},
      {"generators[0].count", "must give at most 134217728 bodies in total",
       [](Scene& s) { s.generators[0].count = limits::max_bodies - 1; }},
      {"generators[0].radius_max", "must lie in [0.001, 1e+09] m",
       [](Scene& s) { s.generators[0].radius_max = 0; }},
      {"generators[0].radius_max", "must be at most 50 m, for the spheres to fit",
       [](Scene& s) { s.generators[0].radius_max = 50.1; }},
      {"generators[0].variant", "must be paper",
       [](Scene& s) { s.generators[0].variant = static_cast<Variant>(9); }},
      {"generators[1].variant", "must be paper in all generators except one",
       [](Scene& s) {
         s.generators.push_back({});
         for (BoxCollider& g : s.generators) g.variant = Variant::scaled;
       }},
      {"generators[0].spawn", "must be inside",
       [](Scene& s) { s.generators[0].spawn = static_cast<Spawn>(9); }},
      {"generators[0].speed_max", "must lie in [0, 1e+09] m/s",
       [](Scene& s) { s.generators[0].speed_max = -1; }},
      {"generators[0].material", "must be the index", [](Scene& s) { s.generators[0].material = 5; }},
      {"generators[0]", "needs a \"box\"", [](Scene& s) { s.box.reset(); }},
      {"generators[0].count", "must be smaller: the box would extend to",
       [](Scene& s) {
         s.generators[0] = {.count = 1'000'000, .radius_max = 1e7, .variant = Variant::scaled};
       }},
      {"obstacles[0].normal", "must be a vector of length 1", [](Scene& s) { s.obstacles[0].normal *= 2; }},
      {"obstacles[0].offset", "must lie in", [](Scene& s) { s.obstacles[0].offset = nan_value; }},
      {"obstacles[0].material", "must be the index", [](Scene& s) { s.obstacles[0].material = 9; }},
      {"boxes[0].shape", "must be plane with the solver impulse (boxes need soft_step)",
       [](Scene& s) { s.boxes.resize(1); }},
      {"boxes[1].center[2]", "must lie in [-1e+09, 1e+09] m",
       [](Scene& s) { boxes(s)[1].center[2] = nan_value; }},
      {"boxes[1].size[0]", "must lie in [1e-09, 1e+09] m", [](Scene& s) { boxes(s)[1].size[0] = -1; }},
      {"boxes[1].orientation", "must be a quaternion of length 1",
       [](Scene& s) { boxes(s)[1].orientation = Quaterniond(2, 0, 0, 0); }},
      {"boxes[1].material", "must be the index", [](Scene& s) { boxes(s)[1].material = 9; }},
      {"camera.position[1]", "must lie in", [](Scene& s) { s.camera.position->y() = 1e10; }},
      {"camera.target", "must differ", [](Scene& s) { s.camera.target = s.camera.position; }},
      {"camera.up", "must not be zero", [](Scene& s) { s.camera.up.setZero(); }},
      {"camera.up", "must not point along the line of sight",
       [](Scene& s) {
         s.camera.up = {-2, 0, 0};
       }},
      {"camera.vertical_field_of_view", "must lie in [1, 150] degrees",
       [](Scene& s) { s.camera.vertical_field_of_view = 151; }},
  };
  for (const Case& c : cases) {
    Scene scene = full_scene();
    c.change(scene);
    const std::vector<Fault> faults = validate(scene);
    ASSERT_FALSE(faults.empty()) << c.path << ": " << c.message;
    EXPECT_EQ(faults[0].path, c.path);
    EXPECT_THAT(faults[0].message, StartsWith(c.message)) << c.path;
    // A fault in the name of the first material causes further faults.
    if (c.path != "materials" && c.path != "materials.default") {
      EXPECT_EQ(faults.size(), 1u) << c.path << ", and " << faults.back().path;
    }
  }
}

TEST(Validate, NamesEveryFaultOfJoints) {
  const std::vector<Case> cases = {
      {"joints", "must be empty with the solver impulse",
       [](Scene& s) { s.physics.solver = Solver::impulse; }},
      {"effects", "must contain rotation if joints apply torques",
       [](Scene& s) { s.physics.effects = Effects{.gravity = true, .joints = true}; }},
      {"joints[0].kind", "must be distance, spring, ball or hinge",
       [](Scene& s) { s.joints[0].kind = static_cast<JointKind>(9); }},
      {"joints[0].a", "must be the id of a body, below 2002", [](Scene& s) { s.joints[0].a = 2002; }},
      {"joints[0].a", "must be the id", [](Scene& s) { s.joints[0].a = -1; }},
      {"joints[0].b", "must be the id", [](Scene& s) { s.joints[0].b = 5000; }},
      {"joints[0].b", "must be a body other than a", [](Scene& s) { s.joints[0].b = s.joints[0].a; }},
      {"joints[0].anchor_a[1]", "must lie in", [](Scene& s) { s.joints[0].anchor_a.y() = nan_value; }},
      {"joints[0].anchor_b[2]", "must lie in", [](Scene& s) { s.joints[0].anchor_b = Vector3d(0, 0, 2e9); }},
      {"joints[0].anchor_b", "must be given for a joint to the world",
       [](Scene& s) { s.joints[0].b.reset(); }},
      {"joints[0].length", "must lie in [1e-09, 1e+09] m", [](Scene& s) { s.joints[0].length = 0; }},
      {"joints[0].min_length", "must lie in", [](Scene& s) { s.joints[0].min_length = -1; }},
      {"joints[0].max_length", "must lie in", [](Scene& s) { s.joints[0].max_length = infinite; }},
      {"joints[0].length", "must not be given with",
       [](Scene& s) { s.joints[0].length = s.joints[0].max_length = 3; }},
      {"joints[0].max_length", "must be at least min_length",
       [](Scene& s) {
         s.joints[0].min_length = 3;
         s.joints[0].max_length = 2;
       }},
      {"joints[1].frequency", "must lie in [1e-06, 1e+09] Hz", [](Scene& s) { s.joints[1].frequency = 0; }},
      {"joints[1].damping_ratio", "must lie in [0, 1000]",
       [](Scene& s) { s.joints[1].damping_ratio = -0.1; }},
      {"joints[2].axis", "must be a vector of length 1", [](Scene& s) { s.joints[2].axis *= 2; }},
      {"joints[2].limits[1]", "must lie in [-180, 180] degrees",
       [](Scene& s) {
         s.joints[2].limits = {-10, 181};
       }},
      {"joints[2].limits", "must be two angles, the smaller first",
       [](Scene& s) {
         s.joints[2].limits = {10, -10};
       }},
  };
  Scene jointed = full_scene();
  jointed.physics.solver = Solver::soft_step;
  jointed.joints.resize(3);
  for (Joint& joint : jointed.joints) joint.b = 1;
  jointed.joints[1].kind = JointKind::spring;
  jointed.joints[2].kind = JointKind::hinge;
  EXPECT_TRUE(validate(jointed).empty());
  for (const Case& c : cases) {
    Scene scene = jointed;
    c.change(scene);
    const std::vector<Fault> faults = validate(scene);
    ASSERT_EQ(faults.size(), 1u) << c.path << ": " << c.message;
    EXPECT_EQ(faults[0].path, c.path);
    EXPECT_THAT(faults[0].message, StartsWith(c.message)) << c.path;
  }
  jointed.physics.effects = Effects{.gravity = true};
  jointed.physics.solver = Solver::impulse;
  EXPECT_TRUE(validate(jointed).empty()) << "a list of effects may leave them out";
}

TEST(Validate, ListsAllFaultsInTheOrderOfTheFormat) {
  Scene scene = full_scene();
  scene.camera.vertical_field_of_view = 0;
  scene.bodies[1].radius = nan_value;
  scene.physics.substeps = -3;
  scene.box->min[0] = nan_value;
  std::vector<std::string> paths;
  for (const Fault& fault : validate(scene)) paths.push_back(fault.path);
  EXPECT_THAT(paths, testing::ElementsAre("box.min[0]", "substeps", "bodies[1].radius",
                                          "camera.vertical_field_of_view"));
}

TEST(Validate, EdgesOfRangesBelong) {
  Scene scene = full_scene();
  scene.bodies[0].radius = 1e-9;
  scene.bodies[1].radius = 50;
  scene.bodies[1].mass = 1e30;
  scene.bodies[1].inertia = Vector3d(1, 1, 2);  // a flat disc
  scene.generators[0].count = limits::max_bodies - 2;
  scene.physics.substeps = 1000;
  EXPECT_TRUE(validate(scene).empty());
}

TEST(Validate, UnitMeansToAFewBits) {
  EXPECT_TRUE(is_unit(1));
  EXPECT_TRUE(is_unit(1 + 1e-15));
  EXPECT_FALSE(is_unit(1 + 1e-13));
  EXPECT_FALSE(is_unit(nan_value));
}

}  // namespace
}  // namespace collidoscope
