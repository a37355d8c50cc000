#pragma once
// Scenes for tests: a few explicit bodies, or a named scene of the project.

#include <string>
#include "tests/random.h"

#include "sim_cuda/scene/scene_file.h"
#include "tests/test_files.h"

namespace collidoscope {

inline Scene project_scene(const std::string& name) {
  return read_scene(project_file("assets/scenes/" + name + ".json").string());
}

/// No box, no gravity, elastic, solver impulse.
inline Scene empty_space() {
  Scene scene;
  scene.name = "test";
  scene.physics.solver = Solver::impulse;
  scene.physics.gravity = Vector3d(0, 0, 0);
  scene.materials[0].restitution = 1;
  return scene;
}

/// No box, in double, elastic by default. For soft_step and the event-driven reference.
inline Scene hard_space(Vector3d gravity = Vector3d(0, 0, 0), double restitution = 1) {
  Scene scene = empty_space();
  scene.physics.solver = Solver::soft_step;
  scene.physics.precision = Precision::f64;
  scene.physics.gravity = gravity;
  scene.physics.restitution_threshold = 0;
  scene.materials[0].restitution = restitution;
  return scene;
}

inline Body sphere(double radius, Vector3d position, Vector3d velocity = Vector3d(0, 0, 0)) {
  Body body;
  body.radius = radius;
  body.position = position;
  body.velocity = velocity;
  return body;
}

/// With the solver impulse.
inline Scene box_collider(std::int64_t count, Variant variant = Variant::paper, std::uint64_t seed = 1) {
  Scene scene;
  scene.name = "Box Collider";
  scene.physics.solver = Solver::impulse;
  scene.box = Box{};
  BoxCollider generator;
  generator.count = count;
  generator.variant = variant;
  generator.seed = seed;
  scene.generators = {generator};
  return scene;
}

/// Up to `most` spheres of mixed sizes in a random cloud. Some coincide, some move.
inline Scene random_scene(unsigned seed, int most = 200) {
  Random random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  Scene scene = empty_space();
  const int count = static_cast<int>(random() % static_cast<unsigned>(most + 1));
  const double spread = uniform(0.5, 40), flat = random() % 4 == 0 ? 0 : 1;
  for (int i = 0; i < count; ++i) {
    Body body =
        sphere(random() % 8 == 0 ? uniform(3, 10) : uniform(0.01, 2),
               Vector3d(uniform(-spread, spread), uniform(-spread, spread), flat * uniform(-spread, spread)),
               Vector3d(uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)));
    if (i > 0 && random() % 16 == 0)
      body.position = scene.bodies[random() % static_cast<unsigned>(i)].position;
    scene.bodies.push_back(body);
  }
  if (random() % 2) scene.box = Box{Vector3d(-50, -50, -50), Vector3d(50, 50, 50)};
  if (random() % 2) scene.physics.gravity = Vector3d(0, 0, -9.81);
  return scene;
}

}  // namespace collidoscope
