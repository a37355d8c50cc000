#include "tests/any_scene.h"

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/scene_file.h"
#include "tests/random.h"

namespace collidoscope {
namespace {

class Maker {
 public:
  Maker(std::uint32_t seed, Values values) : uniform_{Random(seed)}, extreme_(values == Values::extreme) {}

  Scene scene() {
    Scene scene;
    scene.name = "any";
    physics(scene.physics);
    soft_ = scene.physics.solver != Solver::impulse;
    if (once_in(2)) box(scene);
    materials(scene);
    bodies(scene);
    obstacles(scene);
    if (soft_ && scene.bodies.size() > 1 && once_in(3)) joints(scene);
    if (once_in(10)) scene.physics.effects = effects(scene);
    return scene;
  }

 private:
  bool once_in(int times) { return below(times) == 0; }
  int below(int count) { return static_cast<int>(uniform_.random() % static_cast<unsigned>(count)); }
  template <class Choice>
  Choice one_of(std::initializer_list<Choice> choices) {
    return choices.begin()[below(static_cast<int>(choices.size()))];
  }

  /// Returns a random size. An ordinary scene draws from `low` to `high`; an extreme scene draws its
  /// magnitude from `least` to `most`.
  double size(double low, double high, double least, double most) {
    if (!extreme_ || !once_in(4)) return uniform_(low, high);
    if (once_in(4)) return least;
    if (once_in(4)) return most;
    return least * std::exp2(uniform_(0, std::log2(most / least)));
  }
  double signed_size(double ordinary, double most) {
    const double value = once_in(4) ? 0 : size(0, ordinary, 1e-30, most);
    return once_in(2) ? -value : value;
  }
  Vector3d vector(double ordinary, double most) {
    const double x = signed_size(ordinary, most), y = signed_size(ordinary, most);
    return {x, y, signed_size(ordinary, most)};
  }
  Vector3d direction() {
    const Vector3d v = uniform_.vector(1);
    const double length = std::sqrt(v.squaredNorm());
    return once_in(2) || length < 0.01 ? Vector3d(0, 0, 1) : Vector3d(v / length);
  }
  Quaterniond turn() {
    Quaterniond q(uniform_(-1, 1), uniform_(-1, 1), uniform_(-1, 1), uniform_(0.1, 1));
    q.coeffs() /= std::sqrt(q.squaredNorm());
    q.coeffs() /= std::sqrt(q.squaredNorm());
    return once_in(2) ? Quaterniond(1, 0, 0, 0) : q;
  }

  void physics(Physics& p) {
    p.solver = one_of({Solver::impulse, Solver::soft_step, Solver::soft_step, Solver::jacobi_split});
    const bool soft = p.solver != Solver::impulse;
    p.integrator = one_of({Integrator::semi_implicit_euler, Integrator::velocity_verlet, Integrator::rk4});
    p.rotation_update = one_of({RotationUpdate::first_order, RotationUpdate::lie_group});
    p.precision = one_of({Precision::f32, Precision::f64});
    p.gravity = once_in(4) ? vector(10, limits::max_gravity) : Vector3d(0, 0, -9.81);
    if (once_in(2)) {
      p.time_step = TimeStep::per_second(one_of({30, 60, 240}));
    } else {
      p.time_step = size(1.0 / 240, 1.0 / 30, limits::min_time_step, limits::max_time_step);
    }
    if (once_in(2)) p.substeps = 1 + below(5);
    p.iterations = 1 + below(3);
    if (once_in(3)) p.restitution_threshold = size(0, 1, 1e-30, limits::max_speed);
    if (soft && once_in(4)) p.sleep = Sleep{size(0, 0.1, 1e-30, limits::max_speed), uniform_(0, 0.3)};
    if (once_in(4)) {
      p.drag.viscosity = size(0, 1, 1e-30, limits::max_viscosity);
      p.drag.density = size(0, 10, 1e-30, limits::max_medium_density);
    }
    if (soft && once_in(6)) {
      Attractor attractor;
      attractor.position = vector(20, limits::max_coordinate);
      attractor.softening = size(1, 5, limits::min_softening, limits::max_softening);
      attractor.strength = uniform_(-1, 1) * attractor.softening * attractor.softening * 20;
      p.attractors.push_back(attractor);
    }
  }

  void box(Scene& scene) {
    const double side = uniform_(20, 60);
    const Vector3d corner = vector(10, extreme_ ? 1e6 : 10);
    scene.box = Box{corner, corner + Vector3d(side, uniform_(20, 60), uniform_(20, 60))};
  }

  void materials(Scene& scene) {
    const int count = below(3);
    for (int k = 0; k < count; ++k) scene.materials.push_back({"m" + std::to_string(k)});
    for (Material& m : scene.materials) {
      m.density = size(100, 10'000, limits::min_density, limits::max_density);
      m.restitution = one_of({0.0, 1.0, 0.8, uniform_(0, 1)});
      if (!soft_) continue;
      m.friction = once_in(2) ? size(0, 1, 1e-6, limits::max_friction) : 0;
      m.rolling_resistance = once_in(4) ? size(0, 0.5, 1e-6, limits::max_rolling_resistance) : 0;
    }
  }

  int material(const Scene& scene) { return below(static_cast<int>(scene.materials.size())); }

  Body body(const Scene& scene) {
    Body b;
    b.radius = size(0.1, 3, limits::min_radius, 9);
    const Vector3d middle = scene.box ? Vector3d((scene.box->min + scene.box->max) / 2) : Vector3d(0, 0, 0);
    b.position = middle + vector(10, extreme_ ? 1e8 : 10);
    if (!scene.bodies.empty() && once_in(12))
      b.position =
          scene.bodies[static_cast<std::size_t>(below(static_cast<int>(scene.bodies.size())))].position;
    b.orientation = turn();
    b.motion = once_in(8) ? one_of({Motion::kinematic, Motion::fixed}) : Motion::dynamic;
    if (b.motion != Motion::fixed) {
      if (once_in(2)) b.velocity = vector(20, limits::max_speed);
      if (once_in(3)) b.angular_velocity = vector(20, limits::max_spin);
    }
    if (once_in(4)) b.mass = size(0.1, 100, limits::min_mass, limits::max_mass);
    b.material = material(scene);
    if (once_in(6)) b.inertia = inertia(b, scene);
    return b;
  }

  /// Random moments of inertia. In an ordinary body the mass fills its sphere or is concentrated near the
  /// centre.
  Vector3d inertia(const Body& b, const Scene& scene) {
    const double density = scene.materials[static_cast<std::size_t>(b.material)].density;
    const double mass = b.mass.value_or(density * 4.18879 * b.radius * b.radius * b.radius);
    const double solid = std::clamp(0.4 * mass * b.radius * b.radius, 1e-30, 1e30);
    const double least = once_in(2) ? 0.4 * solid : std::min(solid, std::exp2(uniform_(-13, 10)));
    const double moment = size(least, solid, limits::min_inertia, limits::max_inertia / 2);
    return {moment, moment * uniform_(1, 1.3), moment * uniform_(1, 1.6)};
  }

  void bodies(Scene& scene) {
    const int listed = one_of({0, 1, 2, 3, 10, 40});
    for (int k = 0; k < listed; ++k) scene.bodies.push_back(body(scene));
    if (scene.box && once_in(2)) {
      BoxCollider generator;
      generator.count = below(40);
      generator.radius_max = uniform_(0.5, 3);
      generator.spawn = one_of({Spawn::inside, Spawn::centres, Spawn::apart});
      generator.seed = uniform_.random();
      generator.speed_max = once_in(2) ? uniform_(0, 20) : 0;
      generator.material = material(scene);
      if (generator.count > 3 && once_in(3)) generator.excluded = {0, generator.count / 2};
      scene.generators.push_back(generator);
    }
    if (once_in(4)) scene.extra_bodies.push_back(body(scene));
  }

  void obstacles(Scene& scene) {
    if (!scene.box || once_in(4))
      scene.obstacles.push_back({direction(), signed_size(12, limits::max_coordinate), material(scene)});
    if (!soft_ || !once_in(4)) return;
    BoxObstacle box;
    box.center = vector(10, limits::max_coordinate);
    box.size = Vector3d(size(0.5, 10, 1e-6, 1e6), size(0.5, 10, 1e-6, 1e6), size(0.5, 10, 1e-6, 1e6));
    box.orientation = turn();
    box.material = material(scene);
    scene.boxes.push_back(box);
  }

  void joints(Scene& scene) {
    const int count = 1 + below(4), bodies = static_cast<int>(scene.bodies.size());
    for (int k = 0; k < count; ++k) {
      Joint joint;
      joint.kind = one_of({JointKind::distance, JointKind::spring, JointKind::ball, JointKind::hinge});
      joint.a = below(bodies);
      const int b = below(bodies);
      if (b != joint.a) joint.b = b;
      const Body& of_a = scene.bodies[static_cast<std::size_t>(joint.a)];
      if (!joint.b) joint.anchor_b = of_a.position + uniform_.vector(2);
      if (once_in(3)) joint.anchor_a = vector(1, 10);
      if (joint.kind == JointKind::spring) {
        joint.frequency = size(0.5, 5, limits::min_frequency, 1e3);
        joint.damping_ratio = uniform_(0, 1);
      }
      if (joint.kind == JointKind::distance && once_in(2)) joint.max_length = uniform_(1, 5);
      if (joint.kind == JointKind::hinge) {
        joint.axis = direction();
        if (once_in(2)) joint.limits = {-uniform_(0, 90), uniform_(0, 90)};
      }
      joint.collide = once_in(2);
      scene.joints.push_back(joint);
    }
  }

  /// The effects that the scene requires, with some left out at random.
  Effects effects(const Scene& scene) {
    Effects all = required_effects(scene, InitialBodies{});
    all.rotation |= once_in(2);
    if (once_in(3)) all.gravity = false;
    if (once_in(3)) all.drag = false;
    return all;
  }

  Uniform uniform_;
  bool extreme_, soft_ = false;
};

/// Also checks the generated bodies: masses derived from densities, and free space for all spheres.
bool is_valid(const Scene& scene) {
  if (!validate(scene).empty()) return false;
  try {
    initial_bodies(scene);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

Scene any_scene(std::uint32_t seed, Values values) {
  for (std::uint32_t attempt = 0;; ++attempt) {
    Scene scene = Maker(seed * 2654435761u + attempt, values).scene();
    if (is_valid(scene)) return scene;
  }
}

}  // namespace collidoscope
