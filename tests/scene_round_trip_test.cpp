// Tests that a scene that is written and read again keeps every bit. Damaged files give faults or a valid
// scene.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <random>

#include "sim_cuda/scene/names.h"
#include "tests/scene_text.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

/// Random scenes for the round trip: every field, with awkward values.
class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {}

  Scene make() {
    Scene s;
    s.name =
        pick<std::string>({"", "plain", "quote \" and \\ and /", "\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80"});
    if (coin()) {
      s.box = Box{};
      s.box->min = vector(50);
      s.box->max = s.box->min + Vector3d(real(1, 1e3), real(1, 1e3), real(1, 1e3));
    }
    Physics& p = s.physics;
    p.gravity = coin() ? vector(20) : Vector3d(0, -0.0, 0);
    p.time_step = real(1e-4, 0.1);
    if (coin()) {
      p.time_step = TimeStep::per_second(1 + static_cast<int>(random_() % 1000));
    }
    p.solver = pick({Solver::impulse, Solver::soft_step});
    if (coin()) p.drag = {real(0, 1), real(0, 1000), real(0, 2)};
    if (p.solver == Solver::soft_step && coin()) p.attractors = {{vector(100), real(-9, 9), real(1, 2)}, {}};
    if (coin()) p.substeps = 1 + static_cast<int>(random_() % 1000);
    p.iterations = 1 + static_cast<int>(random_() % 1000);
    p.integrator = pick({Integrator::semi_implicit_euler, Integrator::velocity_verlet, Integrator::rk4});
    p.rotation_update = pick({RotationUpdate::first_order, RotationUpdate::lie_group});
    p.precision = pick({Precision::f32, Precision::f64});
    if (coin()) p.effects = Effects{.gravity = coin(), .rotation = coin()};
    if (coin()) p.restitution_threshold = real(0, 2);
    if (coin() && p.solver == Solver::soft_step) p.sleep = Sleep{real(0, 1), real(0, 10)};
    s.materials[0].density = real(1, 1e4);
    for (const char* name : {"steel", "a b", "x.y[3]", "\xC3\xA9"}) {
      if (coin())
        s.materials.push_back({.name = name, .density = real(1e-3, 1e5), .restitution = real(0, 1)});
    }
    for (int i = static_cast<int>(random_() % 4); i > 0; --i) s.bodies.push_back(body(s));
    for (int i = static_cast<int>(random_() % 3); s.box && i > 0; --i) {
      s.generators.push_back(
          {.count = static_cast<std::int64_t>(random_() % 100000),
           .radius_max = real(0.001, 0.5),
           .variant = i == 1 ? pick({Variant::paper, Variant::scaled, Variant::equal}) : Variant::paper,
           .spawn = pick({Spawn::inside, Spawn::centres, Spawn::apart}),
           .seed = random_(),
           .speed_max = real(0, 10),
           .material = material(s)});
    }
    for (int i = static_cast<int>(random_() % 3); i > 0; --i) {
      s.obstacles.push_back(
          {.normal = vector(1).normalized(), .offset = real(-10, 10), .material = material(s)});
    }
    for (int i = static_cast<int>(random_() % 4); s.bodies.size() > 1 && i > 0; --i)
      s.joints.push_back(joint());
    if (s.physics.solver == Solver::impulse) s.physics.effects = Effects{};
    if (s.physics.solver == Solver::soft_step && coin())
      s.boxes.push_back({vector(10), Vector3d(real(1, 2), real(1, 2), real(1, 2)),
                         Quaterniond(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)).normalized(),
                         material(s)});
    if (coin()) s.camera.position = vector(1000);
    if (coin()) s.camera.target = vector(1000);
    s.camera.up = vector(1);
    s.camera.vertical_field_of_view = real(1, 150);
    return s;
  }

 private:
  Body body(const Scene& s) {
    Body b;
    b.radius = real(1e-3, 0.5);
    if (coin()) {
      b = Body{};
      b.shape = Shape::mesh;
      b.mesh = pick<std::string>({"a.obj", "dir/b c.obj", "C:\\x.obj", "\xC3\xA9.obj"});
    }
    b.position = vector(1e6);
    b.motion = pick({Motion::dynamic, Motion::kinematic});
    if (coin()) b.orientation = Quaterniond(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)).normalized();
    if (coin()) b.velocity = coin() ? vector(100) : Vector3d(-0.0, 0, 0);
    if (coin()) b.angular_velocity = vector(100);
    if (coin()) b.mass = real(1e-20, 1e20);
    if (coin()) b.inertia = Vector3d(real(1, 2), real(1, 2), real(1, 2));
    b.material = material(s);
    return b;
  }
  Joint joint() {
    Joint j;
    j.kind = pick({JointKind::distance, JointKind::spring, JointKind::ball, JointKind::hinge});
    j.a = coin() ? 0 : 1;
    if (coin()) j.b = 1 - j.a;
    j.anchor_a = coin() ? vector(10) : Vector3d(0, -0.0, 0);
    if (!j.b || coin()) j.anchor_b = vector(10);
    const bool spring = j.kind == JointKind::spring;
    if ((spring || j.kind == JointKind::distance) && coin())
      j.length = real(0.1, 9);
    else if (j.kind == JointKind::distance && coin())
      j.min_length = real(0, 1), j.max_length = real(1, 2);
    if (spring) j.frequency = real(1, 9), j.damping_ratio = real(0, 2);
    if (j.kind == JointKind::hinge) j.axis = vector(1).normalized();
    if (j.kind == JointKind::hinge && coin()) j.limits = {real(-180, 0), real(0, 180)};
    j.collide = coin();
    return j;
  }
  bool coin() { return random_() % 2 == 0; }
  int material(const Scene& s) { return static_cast<int>(random_() % s.materials.size()); }
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vector3d vector(double most) { return {real(-most, most), real(-most, most), real(-most, most)}; }
  template <class Value>
  Value pick(std::initializer_list<Value> values) {
    return values.begin()[random_() % values.size()];
  }
  std::mt19937_64 random_;
};

/// All bits of a scene's fields, one line per value, independent of write_scene().
std::string scene_bits(const Scene& s) {
  std::string text;
  const auto real = [&](double x) { text += std::to_string(std::bit_cast<std::uint64_t>(x)) + " "; };
  const auto vec = [&](const Vector3d& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  };
  const auto whole = [&](auto x) { text += std::to_string(x) + " "; };
  text += s.name + "\n";
  whole(s.box.has_value());
  if (s.box) vec(s.box->min), vec(s.box->max);
  const Physics& p = s.physics;
  real(p.drag.viscosity), real(p.drag.density), real(p.drag.coefficient);
  for (const Attractor& a : p.attractors) vec(a.position), real(a.strength), real(a.softening);
  vec(p.gravity), real(p.time_step), whole(p.time_step.steps_per_second().value_or(-1)),
      whole(p.substeps.value_or(-1)), whole(p.iterations);
  whole(static_cast<int>(p.solver)), whole(static_cast<int>(p.integrator)),
      whole(static_cast<int>(p.rotation_update)), whole(static_cast<int>(p.precision));
  whole(p.effects ? p.effects->gravity + 2 * p.effects->rotation : -1),
      real(p.restitution_threshold.value_or(-1));
  whole(p.sleep.has_value()), real(p.sleep.value_or(Sleep{}).speed), real(p.sleep.value_or(Sleep{}).time);
  for (const Material& m : s.materials) {
    text += "\n" + m.name + " ";
    real(m.density), real(m.restitution), real(m.friction), real(m.rolling_resistance);
  }
  for (const Body& b : s.bodies) {
    text += "\n" + b.mesh + " ";
    whole(static_cast<int>(b.motion));
    whole(static_cast<int>(b.shape)), real(b.radius), vec(b.position), vec(b.velocity),
        vec(b.angular_velocity);
    real(b.orientation.w()), real(b.orientation.x()), real(b.orientation.y()), real(b.orientation.z());
    real(b.mass.value_or(-1)), vec(b.inertia.value_or(Vector3d(-1, -1, -1))), whole(b.material);
  }
  for (const BoxCollider& g : s.generators) {
    text += "\n";
    whole(g.count), real(g.radius_max), whole(static_cast<int>(g.variant)), whole(static_cast<int>(g.spawn));
    whole(g.seed), real(g.speed_max), whole(g.material);
  }
  for (const Plane& o : s.obstacles) text += "\n", vec(o.normal), real(o.offset), whole(o.material);
  for (const BoxObstacle& o : s.boxes) {
    text += "\n", vec(o.center), vec(o.size), whole(o.material);
    real(o.orientation.w()), real(o.orientation.x()), real(o.orientation.y()), real(o.orientation.z());
  }
  const Vector3d unset(-1, -1, -1);
  for (const Joint& j : s.joints) {
    text += "\n";
    whole(static_cast<int>(j.kind)), whole(j.a), whole(j.b.value_or(-1)), whole(j.collide);
    vec(j.anchor_a), vec(j.anchor_b.value_or(unset)), vec(j.axis), real(j.frequency), real(j.damping_ratio);
    for (const std::optional<double>& length : {j.length, j.min_length, j.max_length})
      real(length.value_or(-1));
    if (j.limits) real((*j.limits)[0]), real((*j.limits)[1]);
  }
  text += "\n";
  vec(s.camera.position.value_or(unset)), vec(s.camera.target.value_or(unset)), vec(s.camera.up);
  real(s.camera.vertical_field_of_view);
  return text;
}

TEST(SceneRoundTrip, WritingAndReadingKeepsEveryBit) {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    const Scene scene = RandomScene(seed).make();
    const std::vector<Fault> faults = validate(scene);
    ASSERT_TRUE(faults.empty()) << seed << " " << faults[0].path << " " << faults[0].message;
    const std::string text = write_scene(scene);
    const Scene again = parse_scene(text, "s");
    ASSERT_EQ(scene_bits(again), scene_bits(scene)) << seed << "\n" << text;
    ASSERT_EQ(write_scene(again), text);
  }
}

TEST(SceneRoundTrip, WhoCameAndWhoLeftSurvivesTheRoundTrip) {
  Scene scene;
  scene.box = Box{};
  scene.generators.resize(1);
  scene.generators[0].excluded = {1, 5, 1999};
  scene.extra_bodies.resize(2);
  scene.extra_bodies[1].position = Vector3d(0.1, 0.2, 0.3);
  const Scene again = parse_scene(write_scene(scene), "text");
  EXPECT_EQ(again.generators.at(0).excluded, scene.generators[0].excluded);
  ASSERT_EQ(again.extra_bodies.size(), 2u);
  EXPECT_EQ(again.extra_bodies[1].position, scene.extra_bodies[1].position);
  EXPECT_EQ(write_scene(again), write_scene(scene));
}

TEST(SceneRoundTrip, ScenesOfTheProjectSurviveTheRoundTrip) {
  for (const auto& entry : std::filesystem::directory_iterator(project_file("assets/scenes"))) {
    if (entry.path().extension() != ".json") continue;
    const Scene scene = read_scene(entry.path().string());
    EXPECT_EQ(scene_bits(parse_scene(write_scene(scene), "s")), scene_bits(scene)) << entry.path();
  }
}

// A damaged file gives complete fault lines or a valid scene, whatever byte is changed.
TEST(SceneRoundTrip, SpoiltFilesAreNeverWorseThanFaults) {
  const std::string good = write_scene(RandomScene(5).make());
  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {
    std::string spoilt = good;
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = random() % spoilt.size();
      switch (random() % 3) {
        case 0:
          spoilt[at] = static_cast<char>(random());
          break;
        case 1:
          spoilt.erase(at, random() % 8);
          break;
        default:
          spoilt.insert(at, spoilt.substr(random() % spoilt.size(), random() % 8));
          break;
      }
    }
    for (const std::string& line : scene_faults_of(spoilt))
      EXPECT_THAT(line, testing::MatchesRegex("s:[0-9]+:[0-9]+: .+"));
  }
}
}  // namespace
}  // namespace collidoscope
