#include "headless/bench/bullet_baseline.h"

#if BENCH_BULLET

#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <vector>

namespace collidoscope {
namespace {

btVector3 to_bullet(const Vector3d& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
Vector3d from_bullet(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

}  // namespace

bool has_bullet() { return true; }

struct BulletBaseline::Impl {
  // Order of declaration: the world refers to the members before it.
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broad_phase, &solver, &configuration};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;  ///< movable bodies first
  btScalar time_step = 0;
  int substeps = 1;

  ~Impl() {
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }

  btRigidBody& add(btScalar mass, std::unique_ptr<btCollisionShape> shape, const Material& material,
                   const btTransform& pose = btTransform::getIdentity()) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
    info.m_startWorldTransform = pose;
    info.m_friction = static_cast<btScalar>(std::sqrt(material.friction));
    info.m_restitution = static_cast<btScalar>(std::sqrt(material.restitution));
    bodies.push_back(std::make_unique<btRigidBody>(info));
    shapes.push_back(std::move(shape));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
    return *bodies.back();
  }
  void add_plane(const Vector3d& normal, double offset, const Material& material) {
    add(0, std::make_unique<btStaticPlaneShape>(to_bullet(normal), static_cast<btScalar>(offset)), material);
  }
};

BulletBaseline::BulletBaseline(const World& world, const BodyStates& states, const BulletSettings& settings)
    : impl_(std::make_unique<Impl>()) {
  const Scene& scene = world.scene();
  const InitialBodies& initial = world.initial();
  impl_->time_step = static_cast<btScalar>(scene.physics.time_step);
  impl_->substeps = settings.substeps;
  impl_->world.setGravity(to_bullet(scene.physics.gravity));
  btContactSolverInfo& solving = impl_->world.getSolverInfo();
  solving.m_numIterations = settings.iterations;
  // The same threshold as in this project: twice the speed that gravity adds in a substep.
  solving.m_restitutionVelocityThreshold = static_cast<btScalar>(scene.physics.restitution_threshold.value_or(
      2 * scene.physics.gravity.norm() * scene.physics.time_step / settings.substeps));
  for (std::size_t i = 0; i < initial.size(); ++i) {
    const Quaterniond& q = states.orientation[i];
    const btTransform pose(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                        static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                           to_bullet(states.position[i]));
    const std::size_t material = initial.material.empty() ? 0 : initial.material[i];
    btRigidBody& body = impl_->add(static_cast<btScalar>(initial.mass[i]),
                                   std::make_unique<btSphereShape>(static_cast<btScalar>(initial.radius[i])),
                                   scene.materials[material], pose);
    body.setLinearVelocity(to_bullet(states.velocity[i]));
    body.setAngularVelocity(to_bullet(states.angular_velocity[i]));
  }
  for (const Plane& plane : scene.obstacles)
    impl_->add_plane(plane.normal, plane.offset, scene.materials[static_cast<std::size_t>(plane.material)]);
  if (!initial.box) return;
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d inward(0, 0, 0);
    inward[axis] = 1;
    impl_->add_plane(inward, initial.box->min[axis], scene.materials[0]);
    impl_->add_plane(-inward, -initial.box->max[axis], scene.materials[0]);
  }
}

BulletBaseline::~BulletBaseline() = default;

void BulletBaseline::step() {
  const btScalar h = impl_->time_step / static_cast<btScalar>(impl_->substeps);
  // Each call makes exactly one step of h. With 0 substeps, Bullet does not accumulate rounding errors of the
  // time.
  for (int k = 0; k < impl_->substeps; ++k) impl_->world.stepSimulation(h, 0);
}

BodyStates BulletBaseline::bodies() const {
  BodyStates states;
  for (const auto& body : impl_->bodies) {
    if (body->getInvMass() == 0) break;
    const btTransform& pose = body->getWorldTransform();
    const btQuaternion q = pose.getRotation();
    states.position.push_back(from_bullet(pose.getOrigin()));
    states.orientation.emplace_back(static_cast<double>(q.w()), static_cast<double>(q.x()),
                                    static_cast<double>(q.y()), static_cast<double>(q.z()));
    states.velocity.push_back(from_bullet(body->getLinearVelocity()));
    states.angular_velocity.push_back(from_bullet(body->getAngularVelocity()));
  }
  return states;
}

}  // namespace collidoscope

#else

namespace collidoscope {

bool has_bullet() { return false; }
struct BulletBaseline::Impl {};
BulletBaseline::BulletBaseline(const World&, const BodyStates&, const BulletSettings&) {}
BulletBaseline::~BulletBaseline() = default;
void BulletBaseline::step() {}
BodyStates BulletBaseline::bodies() const { return {}; }

}  // namespace collidoscope

#endif
