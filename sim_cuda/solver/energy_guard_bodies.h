#pragma once
// What the energy guard (energy_guard.h) needs of single bodies: velocities without contacts, the energy that
// contacts add to a body, and the impulses that they give to it.

#include <cstdint>

#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/energy_guard.h"
#include "sim_cuda/solver/energy_terms.h"
#include "sim_cuda/solver/friction.h"

namespace collidoscope {

template <class Real>
struct GuardedBodies {
  using Change = ContactChange<Real>;

  BodyView<Real> bodies;
  std::int64_t body_count;
  const PackedVector3<Real>*start, *start_spin;
  const Real* start_rotation;  ///< see EnergyGuard; null if all moments of inertia are equal
  const PackedVector3<Real>* moved;
  const std::uint8_t* is_free;  ///< see EnergyGuard; null: the integrator is Euler's
  Vector3<Real> gravity;        ///< m/s^2
  const Vector3<Real>* field;   ///< m/s^2, by body; null without attractors
  bool with_gravity;
  bool is_first_substep;  ///< of a step
  Real h;                 ///< s
  GuardedContacts<Real> contacts;
  const WallPlane<Real>* planes;
  int plane_count, surfaces;
  JointView<Real> joints;
  const std::uint8_t* is_jointed;  ///< by body; null without joints
  const TreeMember* members;       ///< by body; null without joint trees
  LoopView<Real> loops;
  SpringImpulses<Real> springs;
  StaticImpulse* static_impulses;
  const StepControl* control;

  SIM_HD bool is_guarded(std::uint32_t body) const {
    return bodies.inverse_mass[body] > 0 && (contacts.asleep == nullptr || contacts.asleep[body] == 0);
  }
  SIM_HD bool moved_freely(int body) const { return is_free != nullptr && is_free[body] != 0; }
  SIM_HD Vector3<Real> pull(int body) const {
    return field != nullptr ? Vector3<Real>(gravity + field[body]) : gravity;
  }
  /// Velocity at the end of the substep without contacts.
  SIM_HD Vector3<Real> free_velocity(int body) const {
    if (moved_freely(body)) return moved[body];
    const Vector3<Real> v = start[body].load() + spring_change(body);
    return with_gravity ? Vector3<Real>(v + h * pull(body)) : v;
  }
  /// The same of the angular velocity, in the current orientation.
  SIM_HD Vector3<Real> free_angular_velocity(int body) const {
    return start_angular_velocity(body) + spring_spin_change(body);
  }
  SIM_HD Vector3<Real> start_angular_velocity(int body) const {
    return angular_state(body).velocity_of(start_spin[body].load());
  }
  SIM_HD Vector3<Real> spring_change(int body) const { return springs.change(bodies, body); }
  SIM_HD Vector3<Real> spring_spin_change(int body) const { return springs.spin_change(bodies, body); }
  /// Springs do work with the mean of the velocities, so half of their change is added.
  SIM_HD Vector3<double> work_velocity(int body) const {
    return wide(start[body]) + wide(spring_change(body)) / 2;
  }
  SIM_HD Vector3<Real> work_angular_velocity(int body) const {
    return start_angular_velocity(body) + spring_spin_change(body) / 2;
  }
  SIM_HD AngularState<Real> angular_state(int body) const {
    return AngularState<Real>::of(bodies, static_cast<std::uint32_t>(body));
  }
  SIM_HD static Vector3d wide(const Vector3<Real>& v) { return widened<Real>(v); }
  /// The first three terms of a body.
  SIM_HD EnergyTerms gain(int body) const {
    EnergyTerms sum{};
    const Vector3<Real> change = bodies.velocity[body].load() - free_velocity(body);
    Vector3<Real> before = Vector3<Real>::Zero(), spin_change = before;
    if (start_spin != nullptr) {
      before = free_angular_velocity(body);
      spin_change = bodies.angular_velocity[body].load() - before;
    }
    sum.values[2] -= gain_by_turning(body);
    if (change.dot(change) == 0 && spin_change.dot(spin_change) == 0) return sum;
    const double m = static_cast<double>(bodies.mass[body]);
    const Vector3<double> d = wide(change);
    sum.values[0] = m * work_velocity(body).dot(d);
    sum.values[1] = m / 2 * d.dot(d);
    if (with_gravity && !moved_freely(body)) {
      const Vector3<double> g = wide(h * pull(body));
      sum.values[2] += m / 2 * g.dot(g + wide(spring_change(body)));
    }
    if (start_spin == nullptr) return sum;
    const AngularState<Real> angular = angular_state(body);
    const Vector3<double> inertia = wide(angular.inertia);
    Vector3<Real> old = work_angular_velocity(body), added = spin_change;
    if (!angular.is_isotropic()) {
      old = angular.axes.conjugate() * old;
      added = angular.axes.conjugate() * added;
    }
    for (int k = 0; k < 3; ++k) {
      sum.values[0] += inertia[k] * wide(old)[k] * wide(added)[k];
      sum.values[1] += inertia[k] / 2 * wide(added)[k] * wide(added)[k];
    }
    return sum;
  }

  /// Change of the energy of the angular momentum at the start, J, because the body has turned since.
  SIM_HD double gain_by_turning(int body) const {
    if (start_rotation == nullptr) return 0;
    const AngularState<Real> angular = angular_state(body);
    if (angular.is_isotropic()) return 0;
    const Vector3<Real> spin = start_spin[body];
    const double gained = angular.energy_of(spin) - static_cast<double>(start_rotation[body]);
    // Rounding of the orientation changes the momentum by this share.
    constexpr double share = sizeof(Real) == 4 ? 4e-7 : 1e-15;
    const Vector3d momentum = wide(spin), velocity = wide(angular.velocity_of(spin));
    using std::sqrt;
    const double rounding = share * sqrt(momentum.dot(momentum) * velocity.dot(velocity));
    return gained > rounding ? gained - rounding : gained < -rounding ? gained + rounding : 0;
  }

  // ---- contacts ----

  SIM_HD bool is_exempt(int body) const {
    if (is_jointed == nullptr || is_jointed[body] == 0) return false;
    return (members == nullptr || members[body] != TreeMember::touching) && !loops.is_touching(body);
  }
  SIM_HD bool has_pressed(std::uint32_t place) const {
    const ContactSums<Real> sum = contacts.sums[place];
    return sum.total > 0 || sum.impact.has_pressed();
  }
  SIM_HD bool touches_plane(int body) const {
    if (contacts.stopped != nullptr && contacts.stopped[body] != 0) return true;
    for (int p = 0; p < surfaces; ++p)
      if (contacts.plane_impulse[p * body_count + body] > 0) return true;
    return false;
  }
  /// True if friction has turned the body in the substep, although it touches nothing now: it was friction of
  /// the last substep, at a plane that the body has left.
  SIM_HD bool has_left_plane(int body) const {
    if (surfaces == 0 || !(gain_by_turning(body) > 0)) return false;
    for (std::uint32_t k = 0; control->contacts > 0 && k < contacts.by_body.count[body]; ++k)
      if (has_pressed(contacts.by_body.end(body, k).contact)) return false;
    return true;
  }
  SIM_HD bool is_moving(std::uint32_t body) const {
    const Vector3<Real> v = bodies.velocity[body];
    if (v.dot(v) > 0) return true;
    if (bodies.angular_velocity == nullptr) return false;
    const Vector3<Real> w = bodies.angular_velocity[body];
    return w.dot(w) > 0;
  }
  SIM_HD Vector3<Real> plane_normal(int surface, int body) const {
    return surface < plane_count ? planes[surface].normal
                                 : contacts.box_planes[(surface - plane_count) * body_count + body].normal;
  }
  /// Sums the impulses at the end of the substep.
  SIM_HD Change change_of(int body) const {
    Change sum{Vector3<Real>::Zero(), Vector3<Real>::Zero()};
    const Real radius = bodies.radius[body];
    for (std::uint32_t k = 0; control->contacts > 0 && k < contacts.by_body.count[body]; ++k) {
      const ContactEnd end = contacts.by_body.end(body, k);
      const PackedContact<Real>& contact = contacts.soft[end.contact];
      sum.impulse += end.template sign<Real>() * contact.impulse * contact.normal;
      if (contacts.plane_friction == nullptr && start_spin == nullptr) continue;
      sum.impulse += end.template sign<Real>() * contact.friction_impulse;
      sum.moment -= (radius + contact.gap / 2) * contact.normal.cross(contact.friction_impulse);
    }
    for (int p = 0; p < surfaces; ++p) {
      const std::int64_t here = p * body_count + body;
      const Real impulse = contacts.plane_impulse[here];
      if (!(impulse > 0)) continue;
      const Vector3<Real> normal = plane_normal(p, body);
      Vector3<Real> by_plane = impulse * normal;
      if (contacts.plane_friction != nullptr) {
        const Vector3<Real> friction = contacts.plane_friction[here];
        by_plane += friction;
        sum.moment -= radius * normal.cross(friction);
      }
      sum.impulse += by_plane;
    }
    return sum;
  }
  /// Sums the opposing impulses.
  SIM_HD Change opposing_of(int body) const {
    Change sum{Vector3<Real>::Zero(), Vector3<Real>::Zero()};
    for (std::uint32_t k = 0; control->contacts > 0 && k < contacts.by_body.count[body]; ++k) {
      const ContactEnd end = contacts.by_body.end(body, k);
      sum.impulse +=
          end.template sign<Real>() * contacts.opposing[end.contact] * contacts.soft[end.contact].normal;
    }
    return sum;
  }

  // ---- totals of the step, when the guard changes a body ----

  /// For the velocity that relax has changed after the move. Ways are rounded as positions are. Bodies at
  /// rest would else do work over ways that rounding has removed.
  SIM_HD void add_push_work(int body) const {
    const Vector3<Real> before = moved[body], after = bodies.velocity[body];
    if (!with_gravity || before == after) return;
    const Vector3<Real> x = bodies.position[body], of_move = x - h * before, of_rest = x - h * after;
    add_push_work(body, Vector3<Real>((x - of_move) / h), Vector3<Real>((x - of_rest) / h));
  }
  /// For a velocity that changes after the move.
  SIM_HD void add_push_work(int body, const Vector3<Real>& before, const Vector3<Real>& after) const {
    if (!with_gravity || is_exempt(body)) return;
    const Real work = -h * bodies.mass[body] * pull(body).dot(before - after);
    if (work != 0) static_impulses[body].push_work += static_cast<double>(work);
  }
  /// In the sum over the island, this is the momentum that planes and static bodies give less.
  SIM_HD void give_to_ground(int body, const Vector3<Real>& velocity_change) const {
    if (static_impulses == nullptr) return;
    const Vector3<double> change = wide(bodies.mass[body] * velocity_change);
    for (int k = 0; k < 3; ++k) static_impulses[body].vector[k] += change[k];
  }
  /// Takes a share of the impulses of planes from the sums of static bodies.
  SIM_HD void take_from_planes(int body, Real share, bool with_vector) const {
    for (int p = 0; p < surfaces; ++p) {
      const Real impulse = contacts.plane_impulse[p * body_count + body];
      if (!(impulse > 0)) continue;
      static_impulses[body].impulse -= static_cast<double>(share * impulse);
      if (!with_vector) continue;
      Vector3<Real> by_plane = impulse * plane_normal(p, body);
      if (contacts.plane_friction != nullptr) by_plane += contacts.plane_friction[p * body_count + body];
      for (int k = 0; k < 3; ++k) static_impulses[body].vector[k] -= static_cast<double>(share * by_plane[k]);
    }
  }
};

}  // namespace collidoscope
