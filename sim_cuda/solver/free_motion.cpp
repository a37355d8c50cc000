#include "sim_cuda/solver/free_motion.h"

#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/dynamics/integrators.h"
#include "sim_cuda/dynamics/move.h"
#include "sim_cuda/dynamics/rotation_updates.h"

namespace collidoscope {

namespace {

template <class Real>
struct NoteVelocities {
  const StoredVector3<Real>* velocity;
  StoredVector3<Real>* before;
  SIM_HD void operator()(int body) const { before[body] = velocity[body].load(); }
};

/// What all bodies fly by.
template <class Real>
struct SmoothField {
  PullView<Real> attractors;
  const Vector3<Real>* at_start;  ///< m/s^2, of attractors, by body; null where the effect is off
  DragLaw<Real> drag;
  bool dragged;
  Vector3<Real> gravity;  ///< m/s^2

  SIM_HD SmoothForces<Real> on(const BodyView<Real>& bodies, int body) const {
    return {attractors, drag, dragged, gravity, bodies.radius[body], bodies.inverse_mass[body]};
  }
  SIM_HD Vector3<Real> pull(int body) const {
    return at_start != nullptr ? Vector3<Real>(gravity + at_start[body]) : gravity;
  }
  /// What the stages "drag" and "forces" make of v; or "drag" and "move".
  SIM_HD Vector3<Real> foreseen(const BodyView<Real>& bodies, int body, Vector3<Real> v, Real h) const {
    if (dragged) v = DragBodies<Real>{bodies, drag, gravity, at_start, h, nullptr}.slowed(body, v);
    return v + h * pull(body);
  }
};

/// The integrate stage: along which velocity each body goes, and which it has then.
template <class Real, Integrator integrator>
struct FlyBodies {
  SmoothField<Real> field;
  BodyView<Real> bodies;
  const StoredVector3<Real>* before;
  StoredVector3<Real>* along;
  const WallPlane<Real>* planes;
  int plane_count;
  Real h;  ///< s
  bool forced;
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> v = bodies.velocity[body];
    const Vector3<Real> start = before[body];
    if (!forced) v += h * field.gravity;
    FreeFlight<Real> flight{v, v};
    if (v == field.foreseen(bodies, body, start, h)) {
      const Vector3<Real> x = bodies.position[body];
      const FreeFlight<Real> smooth = fly(field.on(bodies, body), x, start, field.pull(body));
      if (!enters_a_plane(x, smooth.along, v, bodies.radius[body])) flight = smooth;
    }
    along[body] = flight.along;
    bodies.velocity[body] = flight.after;
  }

  template <class Forces>
  SIM_HD FreeFlight<Real> fly(const Forces& forces, const Vector3<Real>& x, const Vector3<Real>& v,
                              const Vector3<Real>& a) const {
    if constexpr (integrator == Integrator::rk4)
      return rk4_flight(forces, x, v, a, h);
    else
      return verlet_flight(forces, x, v, a, h);
  }

  SIM_HD bool enters_a_plane(const Vector3<Real>& x, const Vector3<Real>& way, const Vector3<Real>& euler,
                             Real radius) const {
    for (int p = 0; p < plane_count; ++p) {
      const Vector3<Real> normal = planes[p].normal;
      const Real gap = normal.dot(x) - planes[p].offset - radius, speed = normal.dot(way);
      if (gap + h * speed < 0 && speed < normal.dot(euler)) return true;
    }
    return false;
  }
};

template <class Real, class Parts>
struct TurnBodies {
  BodyView<Real> bodies;
  Real h;  ///< s
  const StepControl* control;
  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> w = bodies.angular_velocity[body];
    if (turn_freely<Parts>(bodies.orientation[body], w, bodies.inertia[body], h))
      bodies.angular_velocity[body] = w;
  }
};

}  // namespace

template <class Real>
FreeMotion<Real>::FreeMotion(Executor& executor, const SolverScene<Real>& scene)
    : executor_(executor),
      scene_(scene),
      before_(executor, "velocities at the start of a substep"),
      along_(executor, "velocities of ways") {
  if (!flies()) return;
  before_.resize_discarding(static_cast<std::size_t>(scene.body_count));
  along_.resize_discarding(static_cast<std::size_t>(scene.body_count));
}

template <class Real>
void FreeMotion<Real>::begin() {
  if (flies())
    executor_.run("integrate", scene_.body_count,
                  NoteVelocities<Real>{scene_.bodies.velocity, before_.data()});
}

template <class Real>
BodyView<Real> FreeMotion<Real>::ways() const {
  BodyView<Real> bodies = scene_.bodies;
  if (flies()) bodies.velocity = along_.data();
  return bodies;
}

template <class Real>
void FreeMotion<Real>::fly(Real h, bool forced) {
  if (!flies()) return;
  const auto with = [&]<Integrator integrator>() {
    const Effects& effects = scene_.effects;
    const SmoothField<Real> field{effects.attractor ? scene_.attractors : PullView<Real>{},
                                  effects.attractor ? scene_.field : nullptr, scene_.drag, effects.drag,
                                  scene_.gravity};
    executor_.run("integrate", scene_.body_count,
                  FlyBodies<Real, integrator>{field, scene_.bodies, before_.data(), along_.data(),
                                              scene_.planes, scene_.plane_count, h, forced, scene_.control});
  };
  scene_.integrator == Integrator::rk4 ? with.template operator()<Integrator::rk4>()
                                       : with.template operator()<Integrator::velocity_verlet>();
}

template <class Real>
void FreeMotion<Real>::move(Real h, bool forced, const std::uint8_t* asleep, const HeldMotion<Real>& held) {
  const bool turns = scene_.effects.rotation && scene_.rotation_update == RotationUpdate::lie_group;
  Effects moving = scene_.effects;
  if (forced || flies()) moving.gravity = false;  // it is in the velocities
  if (turns) moving.rotation = false;
  move_bodies<Real>(executor_, ways(), scene_.body_count, moving, scene_.gravity, scene_.box, h,
                    scene_.control, asleep, held);
  const auto turn = [&]<class Parts>() {
    run_awake_bodies(executor_, "turn", scene_.body_count, asleep,
                     TurnBodies<Real, Parts>{scene_.bodies, h, scene_.control});
  };
  if (turns)
    scene_.integrator == Integrator::rk4 ? turn.template operator()<FourthOrderTurn>()
                                         : turn.template operator()<SecondOrderTurn>();
}

template class FreeMotion<float>;
template class FreeMotion<double>;

}  // namespace collidoscope
