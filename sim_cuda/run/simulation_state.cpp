#include "sim_cuda/run/simulation_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_cuda/dynamics/cayley.h"
#include "sim_cuda/dynamics/wide_spin.h"
#include "sim_cuda/scene/mass_properties.h"

namespace collidoscope {

namespace {

template <class Real>
std::vector<Vector3<Real>> narrowed(const std::vector<Vector3d>& wide) {
  std::vector<Vector3<Real>> narrow(wide.size());
  for (std::size_t i = 0; i < wide.size(); ++i) narrow[i] = wide[i].cast<Real>();
  return narrow;
}
template <class Real>
std::vector<PackedVector3<Real>> stored(const std::vector<Vector3d>& wide) {
  const std::vector<Vector3<Real>> narrow = narrowed<Real>(wide);
  return {narrow.begin(), narrow.end()};
}

template <class Real>
std::vector<BoxSurface<Real>> box_surfaces(const Scene& scene) {
  std::vector<BoxSurface<Real>> surfaces;
  for (const BoxObstacle& box : scene.boxes) {
    const Material& material = scene.materials[static_cast<std::size_t>(box.material)];
    const Matrix3d turn = box.orientation.toRotationMatrix();
    surfaces.push_back({box.center.cast<Real>(),
                        (box.size / 2).cast<Real>(),
                        {turn.col(0).cast<Real>(), turn.col(1).cast<Real>(), turn.col(2).cast<Real>()},
                        static_cast<Real>(material.restitution),
                        static_cast<Real>(material.friction)});
  }
  return surfaces;
}

template <class Real>
std::vector<WallPlane<Real>> wall_planes(const Scene& scene, const std::optional<Box>& box) {
  std::vector<WallPlane<Real>> planes;
  for (const Plane& p : scene.obstacles)
    planes.push_back({p.normal.cast<Real>(), static_cast<Real>(p.offset),
                      static_cast<Real>(scene.materials[static_cast<std::size_t>(p.material)].restitution),
                      static_cast<Real>(scene.materials[static_cast<std::size_t>(p.material)].friction)});
  if (box) {
    const auto e = static_cast<Real>(scene.materials[0].restitution),
               mu = static_cast<Real>(scene.materials[0].friction);
    for (int axis = 0; axis < 3; ++axis) {
      Vector3<Real> inward(0, 0, 0);
      inward[axis] = 1;
      planes.push_back({inward, static_cast<Real>(box->min[axis]), e, mu});
      planes.push_back({-inward, -static_cast<Real>(box->max[axis]), e, mu});
    }
  }
  return planes;
}

/// Restitution threshold, m/s. "auto": twice the velocity change by gravity per substep, so that resting
/// contacts settle. `soft_step` and `jacobi_split` have a threshold that is at least as large (impact.h).
double bounce_threshold(const Physics& physics, int substeps, bool gravity) {
  if (physics.restitution_threshold) return *physics.restitution_threshold;
  return gravity ? 2 * std::sqrt(physics.gravity.dot(physics.gravity)) * physics.time_step / substeps : 0;
}

}  // namespace

MotionBound motion_bound(const Effects& effects) {
  return effects.continuous_collision ? MotionBound::any_direction
         : effects.drag               ? MotionBound::linear_with_drag
                                      : MotionBound::linear;
}

double max_restitution(const Scene& scene) {
  double largest = 0;
  for (const Material& material : scene.materials) largest = std::max(largest, material.restitution);
  return largest;
}

template <class Real>
SimulationState<Real>::SimulationState(Executor& executor, const Scene& scene, const InitialBodies& initial,
                                       const Effects& effects, int substeps)
    : executor_(executor),
      body_count_(static_cast<std::int64_t>(initial.size())),
      effects_(effects),
      box_(initial.box),
      gravity_(effects.gravity ? Vector3<Real>(scene.physics.gravity.cast<Real>()) : Vector3<Real>(0, 0, 0)),
      attractors_(executor, "attractors"),
      field_(executor, "accelerations"),
      bodies_(executor),
      kinematic_(executor, "static and kinematic bodies"),
      mesh_(executor, "body meshes"),
      restitution_of_material_(executor, "restitution by material"),
      max_restitution_(static_cast<Real>(max_restitution(scene))),
      friction_of_material_(executor, "friction by material"),
      rolling_of_material_(executor, "rolling resistance by material"),
      rolling_of_plane_(executor, "rolling resistance by plane"),
      planes_(executor, "walls"),
      box_surfaces_(executor, "box obstacles") {
  executor.throw_if_cancelled();
  upload_bodies(initial);
  executor.throw_if_cancelled();
  if (effects.rotation) upload_rotation(initial);
  upload_materials(scene, initial, substeps);
  if (effects.attractor) upload_attractors(scene);
  upload_surfaces(scene);
  executor.throw_if_cancelled();
}

template <class Real>
void SimulationState<Real>::upload_bodies(const InitialBodies& initial) {
  const std::size_t n = initial.size();
  bodies_.position.upload(narrowed<Real>(initial.position));
  bodies_.velocity.upload(initial.velocity.empty()
                              ? std::vector<PackedVector3<Real>>(n, Vector3<Real>(Vector3<Real>::Zero()))
                              : stored<Real>(initial.velocity));
  std::vector<Real> radius(n), mass(n), inverse_mass(n);
  for (std::size_t i = 0; i < n; ++i) {
    radius[i] = static_cast<Real>(initial.radius[i]);
    mass[i] = static_cast<Real>(initial.mass[i]);
    inverse_mass[i] = 1 / mass[i];
  }
  std::vector<std::uint32_t> kinematic;
  for (std::size_t i = 0; i < initial.motion.size(); ++i) {
    if (initial.motion[i] == Motion::dynamic) continue;
    kinematic.push_back(static_cast<std::uint32_t>(i));
    mass[i] = inverse_mass[i] = 0;
  }
  kinematic_.upload(kinematic);
  bodies_.radius.upload(radius);
  bodies_.mass.upload(mass);
  bodies_.inverse_mass.upload(inverse_mass);
  mesh_.upload(initial.mesh);
}

template <class Real>
void SimulationState<Real>::upload_rotation(const InitialBodies& initial) {
  const std::size_t n = initial.size();
  std::vector<Quaternion<Real>> orientation(n, Quaternion<Real>(1, 0, 0, 0));
  std::vector<PackedVector3<Real>> spin(n, Vector3<Real>(Vector3<Real>::Zero()));
  std::vector<Vector3<Real>> inertia(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!initial.orientation.empty()) orientation[i] = initial.orientation[i].template cast<Real>();
    if (!initial.angular_velocity.empty())
      spin[i] = Vector3<Real>(initial.angular_velocity[i].template cast<Real>());
    inertia[i] = Vector3d(initial.inertia.empty() ? sphere_inertia(initial.mass[i], initial.radius[i])
                                                  : initial.inertia[i])
                     .template cast<Real>();
  }
  for (std::size_t i = 0; i < initial.motion.size(); ++i)
    if (initial.motion[i] != Motion::dynamic)
      inertia[i] = Vector3<Real>::Constant(std::numeric_limits<Real>::infinity());
  unequal_moments_ = !std::ranges::all_of(inertia, is_isotropic<Real>);
  bodies_.orientation.upload(orientation);
  bodies_.angular_velocity.upload(spin);
  bodies_.inertia.upload(inertia);
  if (unequal_moments_ && sizeof(Real) == sizeof(float))
    bodies_.angular_velocity_low.upload(std::vector<Vector3<float>>(n, Vector3<float>::Zero()));
}

template <class Real>
void SimulationState<Real>::upload_materials(const Scene& scene, const InitialBodies& initial, int substeps) {
  if (scene.materials.size() > 1 && !initial.material.empty()) bodies_.material.upload(initial.material);
  std::vector<Real> restitution;
  for (const Material& m : scene.materials) restitution.push_back(static_cast<Real>(m.restitution));
  restitution_of_material_.upload(restitution);
  restitution_ = {restitution_of_material_.data(), bodies_.material.data(),
                  static_cast<Real>(bounce_threshold(scene.physics, substeps, effects_.gravity))};

  if (effects_.friction) {
    std::vector<Real> friction;
    for (const Material& m : scene.materials) friction.push_back(static_cast<Real>(m.friction));
    friction_of_material_.upload(friction);
  }
}

template <class Real>
void SimulationState<Real>::upload_attractors(const Scene& scene) {
  std::vector<PointAttractor<Real>> points;
  for (const Attractor& a : scene.physics.attractors) {
    points.push_back(PointAttractor<Real>::of(a));
    max_field_ += static_cast<Real>(max_field(a));
  }
  attractors_.upload(points);
  field_.resize_discarding(static_cast<std::size_t>(body_count_));
}

/// Uploads planes and boxes with their rolling resistance, and clears the static impulses.
template <class Real>
void SimulationState<Real>::upload_surfaces(const Scene& scene) {
  planes_.upload(wall_planes<Real>(scene, box_));
  if (effects_.rolling_resistance) {
    const auto of = [&](int material) {
      return static_cast<Real>(scene.materials[static_cast<std::size_t>(material)].rolling_resistance);
    };
    std::vector<Real> by_material, by_plane;
    for (int k = 0; k < static_cast<int>(scene.materials.size()); ++k) by_material.push_back(of(k));
    for (const Plane& plane : scene.obstacles) by_plane.push_back(of(plane.material));
    by_plane.resize(planes_.size(), of(0));  // faces of the box
    for (const BoxObstacle& box : scene.boxes) by_plane.push_back(of(box.material));
    rolling_of_material_.upload(by_material);
    rolling_of_plane_.upload(by_plane);
  }
  box_surfaces_.upload(box_surfaces<Real>(scene));
  if (plane_count() > 0 || !scene.boxes.empty() || effects_.gravity || effects_.attractor)
    bodies_.static_impulses.upload(std::vector<StaticImpulse>(static_cast<std::size_t>(body_count_)));
}

template <class Real>
SpeculativeMargin<Real> SimulationState<Real>::speculative_margin_in(Real time) const {
  if (!(time > 0)) return {};
  return {motion_bound(effects_), bodies_.velocity.data(), time, acceleration_margin_in(time),
          max_restitution_};
}

template <class Real>
Real SimulationState<Real>::acceleration_margin_in(Real time) const {
  using std::sqrt;
  return time * time * (sqrt(gravity_.dot(gravity_)) + 2 * max_field_);
}

template <class Real>
SolverScene<Real> SimulationState<Real>::solver_scene(const Scene& scene, int substeps, StepControl* control,
                                                      Joints<Real>* joints) const {
  const Physics& physics = scene.physics;
  const auto time_step = static_cast<Real>(physics.time_step);
  const std::uint16_t* material = bodies_.material.data();
  return {.bodies = bodies_.view(),
          .body_count = body_count_,
          .kinematic = {kinematic_.data(), static_cast<std::int64_t>(kinematic_.size())},
          .restitution = restitution_,
          .friction = {friction_of_material_.data(), material},
          .rolling = {rolling_of_material_.data(), material, rolling_of_plane_.data()},
          .planes = planes_.data(),
          .plane_count = plane_count(),
          .boxes = boxes(),
          .static_impulses = bodies_.static_impulses.data(),
          .gravity = gravity_,
          .drag = DragLaw<Real>::of(physics.drag),
          .attractors = attractors(),
          .field = field_.data(),
          .effects = effects_,
          .box = box_,
          .time_step = time_step,
          .acceleration_margin = acceleration_margin_in(time_step),
          .substeps = substeps,
          .iterations = physics.iterations,
          .integrator = physics.integrator,
          .rotation_update = physics.rotation_update,
          .unequal_moments = unequal_moments_,
          .angular_velocity_low = bodies_.angular_velocity_low.data(),
          .sleep = physics.sleep.value_or(Sleep{}),
          .control = control,
          .joints = joints};
}

template <class Real>
void SimulationState<Real>::download(DeferredParts<BodyStates>& parts) const {
  const auto widened = [](const auto& narrow) {
    std::vector<Vector3d> wide(narrow.size());
    for (std::size_t i = 0; i < narrow.size(); ++i)
      wide[i] = Vector3<Real>(narrow[i]).template cast<double>();
    return wide;
  };
  parts.add([widened, n = static_cast<std::size_t>(body_count_), position = bodies_.position.download(),
             velocity = bodies_.velocity.download()](BodyStates& states) {
    states.position = widened(position);
    states.velocity = widened(velocity);
    states.angular_velocity.assign(n, Vector3d(0, 0, 0));
    states.orientation.assign(n, Quaterniond(1, 0, 0, 0));
  });
  if (!effects_.rotation) return;
  parts.add([widened, angular_velocity = bodies_.angular_velocity.download(),
             orientation = bodies_.orientation.download(),
             low = bodies_.angular_velocity_low.download()](BodyStates& states) {
    states.angular_velocity = widened(angular_velocity);
    for (std::size_t i = 0; i < orientation.size(); ++i)
      states.orientation[i] = orientation[i].template cast<double>();
    for (std::size_t i = 0; i < low.size(); ++i) {
      Vector3d& w = states.angular_velocity[i];
      w = joined(w.cast<float>(), low[i]);
    }
  });
}

template <class Real>
void SimulationState<Real>::upload(const BodyStates& states,
                                   const std::vector<StaticImpulse>& static_impulses) {
  const std::size_t n = states.position.size();
  const auto write = [&](const auto& buffer, const auto& values) {
    executor_.copy_to_executor(buffer.data(), values.data(), n * sizeof values[0]);
  };
  write(bodies_.position, narrowed<Real>(states.position));
  write(bodies_.velocity, stored<Real>(states.velocity));
  if (effects_.rotation) {
    std::vector<Quaternion<Real>> orientation(n);
    for (std::size_t i = 0; i < n; ++i) orientation[i] = states.orientation[i].template cast<Real>();
    write(bodies_.orientation, orientation);
    write(bodies_.angular_velocity, stored<Real>(states.angular_velocity));
    if (bodies_.angular_velocity_low.size() > 0) {
      std::vector<Vector3<float>> low(n);
      std::ranges::transform(states.angular_velocity, low.begin(), low_part);
      write(bodies_.angular_velocity_low, low);
    }
  }
  if (bodies_.static_impulses.size() > 0 && static_impulses.size() >= n)
    write(bodies_.static_impulses, static_impulses);
}

template class SimulationState<float>;
template class SimulationState<double>;

}  // namespace collidoscope
