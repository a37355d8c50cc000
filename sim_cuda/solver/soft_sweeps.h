#pragma once
// One sweep of `soft_step` over all pairs of bodies in contact, colour by colour, then the mass-split set:
// the stages, and what they do with one contact. An act that rubs also gives friction, after what it gives
// along the normal.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/soft_grip.h"

namespace collidoscope {

// ---- acts: b moves at `velocity` relative to a, and `mass`, in kg, is what it works against; returns the
// impulse, N s ----

template <class Real>
struct Solve {
  static constexpr bool rubs = false;
  Softness<Real> softness;
  SIM_HD Real press(SoftContact<Real>& contact, Pair, const Vector3<Real>& velocity, Real mass) const {
    return contact.template solve<true>(velocity.dot(contact.normal), mass, softness);
  }
};

template <class Real, bool friction>
struct Relax {
  static constexpr bool rubs = friction;
  Softness<Real> softness;
  const Real* radius;
  bool last;  ///< of the sweeps of this substep
  SIM_HD Real press(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity, Real mass) const {
    const Real change = contact.template solve<false>(velocity.dot(contact.normal), mass, softness);
    if (last) contact.end_substep(velocity, radius[bodies.a] + radius[bodies.b]);
    return change;
  }
  SIM_HD Vector3<Real> grip(const SoftContact<Real>& contact, SoftGrip<Real>& grip, const Vector3<Real>& slip,
                            Real mass) const {
    const Vector3<Real> change = rub<Real>(slip, mass, grip.coefficient * contact.impulse, grip.impulse);
    if (last) grip.total += grip.impulse;
    return change;
  }
};

template <class Real>
struct Bounce {
  static constexpr bool rubs = false;
  Restitution<Real> restitution;
  SIM_HD Real press(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity, Real mass) const {
    const Real e =
        restitution.between(restitution.of_body(bodies.a), restitution.of_body(bodies.b), contact.approach);
    return contact.bounce(velocity.dot(contact.normal), mass, e);
  }
};

/// Friction once more, within what the whole step has pressed.
template <class Real>
struct Grip {
  static constexpr bool rubs = true;
  SIM_HD Real press(SoftContact<Real>&, Pair, const Vector3<Real>&, Real) const { return 0; }
  SIM_HD Vector3<Real> grip(const SoftContact<Real>& contact, SoftGrip<Real>& grip, const Vector3<Real>& slip,
                            Real mass) const {
    return rub<Real>(slip, mass, grip.coefficient * contact.total, grip.total);
  }
};

// ---- stages ----

/// Of contacts of one colour at a time: no two share a body.
template <class Real, class Act>
struct SweepContact {
  const Pair* contacts;
  SoftContact<Real>* soft;
  SoftGrip<Real>* grips;  ///< read by acts that rub
  BodyView<Real> bodies;
  Act act;

  SIM_HD void operator()(int contact) const {
    const Pair ids = contacts[contact];
    SoftContact<Real> k = soft[contact];
    const Real w_a = bodies.inverse_mass[ids.a], w_b = bodies.inverse_mass[ids.b];
    Vector3<Real> v_a = bodies.velocity[ids.a], v_b = bodies.velocity[ids.b];
    const Real change = act.press(k, ids, v_b - v_a, 1 / (w_a + w_b));
    soft[contact] = k;
    if (change != 0) {
      v_a -= change * w_a * k.normal;
      v_b += change * w_b * k.normal;
    }
    if constexpr (Act::rubs) {
      SoftGrip<Real> grip = grips[contact];
      if (!(k.total > 0) && grip.impulse.dot(grip.impulse) == 0) return store(ids, v_a, v_b, change != 0);
      RubbedPair<Real> pair(bodies, ids, k);
      const Real mass = 1 / (w_a + w_b + pair.ease_a() + pair.ease_b());
      const Vector3<Real> rubbed = act.grip(k, grip, pair.slip(v_b - v_a), mass);
      grips[contact] = grip;
      v_a -= w_a * rubbed;
      v_b += w_b * rubbed;
      pair.turn(rubbed);
      bodies.angular_velocity[ids.a] = pair.a.rate;
      bodies.angular_velocity[ids.b] = pair.b.rate;
      store(ids, v_a, v_b, true);
    } else {
      store(ids, v_a, v_b, change != 0);
    }
  }
  SIM_HD void store(Pair ids, const Vector3<Real>& v_a, const Vector3<Real>& v_b, bool changed) const {
    if (!changed) return;
    bodies.velocity[ids.a] = v_a;
    bodies.velocity[ids.b] = v_b;
  }
};

/// The mass-split set (Tonge, Benevolenski, Voroshilov 2012): a body with n contacts in it counts as n bodies
/// of 1/n of its mass, whose velocities are averaged afterwards.
template <class Real, class Act>
struct SweepSplit {
  const Pair* contacts;
  SoftContact<Real>* soft;
  SoftGrip<Real>* grips;
  BodyView<Real> bodies;
  const std::uint32_t *order, *begin, *count;
  Real* change;           ///< N s, along the normal
  Vector3<Real>* rubbed;  ///< N s, across it; written by acts that rub
  Act act;

  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*begin + static_cast<std::uint32_t>(item)];
    const Pair ids = contacts[contact];
    const Real n_a = static_cast<Real>(count[ids.a]), n_b = static_cast<Real>(count[ids.b]);
    const Real w_a = bodies.inverse_mass[ids.a], w_b = bodies.inverse_mass[ids.b];
    const Vector3<Real> velocity = bodies.velocity[ids.b] - bodies.velocity[ids.a];
    SoftContact<Real>& k = soft[contact];
    change[contact] = act.press(k, ids, velocity, 1 / (w_a * n_a + w_b * n_b));
    if constexpr (Act::rubs) {
      const RubbedPair<Real> pair(bodies, ids, k);
      const Real mass = 1 / ((w_a + pair.ease_a()) * n_a + (w_b + pair.ease_b()) * n_b);
      rubbed[contact] = act.grip(k, grips[contact], pair.slip(velocity), mass);
    }
  }
};

/// A body's share of all its contacts in the set, added in increasing id of the other body.
template <class Real, bool rubs>
struct ApplySplit {
  const Pair* contacts;
  const SoftContact<Real>* soft;
  BodyView<Real> bodies;
  ContactsByBodyView split;
  const Real* change;
  const Vector3<Real>* rubbed;

  SIM_HD void operator()(int body) const {
    const std::uint32_t n = split.count[body];
    if (n == 0) return;
    Vector3<Real> momentum = Vector3<Real>::Zero();
    [[maybe_unused]] Vector3<Real> moment = Vector3<Real>::Zero();
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t contact = split.entry[split.begin[body] + k];
      const Real sign = contacts[contact].a == static_cast<std::uint32_t>(body) ? Real(-1) : Real(1);
      const Vector3<Real> normal = soft[contact].normal;
      momentum += sign * change[contact] * normal;
      if constexpr (rubs) {
        momentum += sign * rubbed[contact];
        moment -= (bodies.radius[body] + soft[contact].gap / 2) * normal.cross(rubbed[contact]);
      }
    }
    bodies.velocity[body] += bodies.inverse_mass[body] * momentum;
    if constexpr (rubs) {
      Spin<Real> spin = Spin<Real>::of(bodies, static_cast<std::uint32_t>(body));
      spin.turn(moment);
      bodies.angular_velocity[body] = spin.rate;
    }
  }
};

}  // namespace collidoscope
