#pragma once
// Baseline: the same bodies simulated by Bullet 2 (E. Coumans et al.), btDiscreteDynamicsWorld with
// sequential impulses, one thread, float. Available if libbullet-dev is installed at build time.
//
// Walls and planes are btStaticPlaneShape. Bullet multiplies the coefficients of a pair, while this project
// uses the geometric mean of frictions. Each body therefore gets the square root of its friction and of its
// restitution; the latter matches for bodies of one material.
// Sleeping and damping are off. All other settings are Bullet's defaults: warm starting, split impulses,
// margins.

#include <memory>

#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/world.h"

namespace collidoscope {

bool has_bullet();

struct BulletSettings {
  int substeps = 2;     ///< per step, each with new contacts
  int iterations = 10;  ///< Bullet's default
};

class BulletBaseline {
 public:
  /// Creates the spheres of `states` in the scene of `world`. Requires has_bullet().
  BulletBaseline(const World& world, const BodyStates& states, const BulletSettings& settings);
  ~BulletBaseline();
  void step();  ///< makes one time step of the scene
  BodyStates bodies() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collidoscope
