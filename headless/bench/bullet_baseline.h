#pragma once
// The same bodies stepped by Bullet 2 (E. Coumans et al.): btDiscreteDynamicsWorld with its sequential
// impulses, on one thread, in float. Compiled where libbullet-dev is.
//
// Walls and planes are btStaticPlaneShape. Where Bullet multiplies the coefficients of a pair we take the
// geometric mean of the frictions, so each body gets the square root of its material's, and of its
// restitution, which is ours for two of one material. Nothing sleeps, nothing is damped. All other settings
// are Bullet's defaults: warm starting, split impulses, margins.

#include <memory>

#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/world.h"

namespace collidoscope {

bool has_bullet();

struct BulletSettings {
  int substeps = 2;     ///< of a step, each with contacts of its own
  int iterations = 10;  ///< Bullet's default
};

class BulletBaseline {
 public:
  /// Spheres where `states` has them, in the scene of `world`. Needs has_bullet().
  BulletBaseline(const World& world, const BodyStates& states, const BulletSettings& settings);
  ~BulletBaseline();
  void step();  ///< one of the scene's time steps
  BodyStates bodies() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace collidoscope
