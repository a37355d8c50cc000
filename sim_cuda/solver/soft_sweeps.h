#pragma once
// One sweep of `soft_step` over all pairs of bodies in contact, colour by colour, then the mass-split set:
// the stages, and what they do with one contact. An act that rubs also gives friction, after what it gives
// along the normal.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/only.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/soft_grip.h"

namespace collidoscope {

// ---- acts: b moves at `velocity` relative to a, and `mass`, in kg, is what it works against; returns the
// impulse, N s ----

/// A foreseen contact stops what would close its gap along today's normal, also of two that will fly past
/// each other. `held`: with continuous collision, which foresees many such, and keeps them apart should they
/// not: those are left alone.
template <class Real, bool held>
struct Solve {
  static constexpr bool rubs = false;
  [[no_unique_address]] Only<held, const Real*> radius;
  Softness<Real> softness;
  SIM_HD Real press(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity, Real mass) const {
    if constexpr (held)
      if (contact.gap > 0 &&
          contact.passes(velocity, radius[bodies.a] + radius[bodies.b], 1 / softness.inverse_h)) {
        const Real change = -contact.impulse;
        contact.impulse = 0;
        return change;
      }
    return contact.template solve<true>(velocity.dot(contact.normal), mass, softness);
  }
};

template <class Real, bool friction>
struct Relax {
  static constexpr bool rubs = friction;
  Softness<Real> softness;
  const Real* radius;
  bool last;  ///< of the sweeps of this substep
  Restitution<Real> restitution;
  std::uint32_t* bounces;  ///< null, but in the last sweep of a step: to be set where something will bounce
  SIM_HD Real press(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity, Real mass) const {
    const Real change = contact.template solve<false>(velocity.dot(contact.normal), mass, softness);
    if (!last) return change;
    contact.end_substep(velocity, [&] { return radius[bodies.a] + radius[bodies.b]; });
    if (bounces != nullptr && contact.total > 0 && restitution.of_pair(bodies, contact.approach) > 0)
      atomic_store(bounces, std::uint32_t{1});
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
  const std::uint32_t* bounces;  ///< 0: nothing will bounce
  SIM_HD bool called_for() const { return read_only(bounces) != 0; }
  SIM_HD Real press(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity, Real mass) const {
    return contact.bounce(velocity.dot(contact.normal), mass, restitution.of_pair(bodies, contact.approach));
  }
};

/// Friction once more, where a contact bounced, within what the whole step has pressed.
template <class Real>
struct Grip {
  static constexpr bool rubs = true;
  const std::uint32_t* bounces;
  SIM_HD bool called_for() const { return read_only(bounces) != 0; }
  SIM_HD Real press(SoftContact<Real>&, Pair, const Vector3<Real>&, Real) const { return 0; }
  SIM_HD Vector3<Real> grip(const SoftContact<Real>& contact, SoftGrip<Real>& grip, const Vector3<Real>& slip,
                            Real mass) const {
    if (!contact.bounced()) return Vector3<Real>::Zero();
    return rub<Real>(slip, mass, grip.coefficient * contact.total, grip.total);
  }
};

// ---- one sweep ----

/// 1/kg, of the two bodies of a contact: beside it, so that a sweep need not look them up.
template <class Real>
struct InverseMasses {
  Real a, b;
};

/// The contacts of a step in the order in which they are swept: colour by colour, then the mass-split set. A
/// contact's place in it is not its number in the list of contacts.
template <class Real, bool rubbed>
struct SweptContacts {
  const Pair* bodies_of;
  const InverseMasses<Real>* inverse_masses;
  SoftContact<Real>* soft;
  [[no_unique_address]] Only<rubbed, SoftGrip<Real>*> grips;
  [[no_unique_address]] Only<rubbed, const GrippedPair<Real>*> gripped;
  const std::uint32_t* begin;         ///< where colour c starts; c = Colouring::colours: the split set
  const std::uint32_t* count;         ///< how many it has
  ContactsByBodyView split;           ///< places of the split set, by body
  const std::uint32_t* split_bodies;  ///< all bodies, or 0 where the set is empty
  [[no_unique_address]] Only<rubbed, Vector3<Real>*> split_rubbed;  ///< N s, across the normal
  Real* split_change;                                               ///< N s, along it
};

/// For Executor::run_rounds: a round for each colour, whose contacts share no body; then the mass-split set
/// (Tonge, Benevolenski, Voroshilov 2012), all at once: a body with n contacts in it counts as n bodies of
/// 1/n of its mass; then what they make of each body.
template <class Real, class Act>
struct Sweep {
  static constexpr bool planned = true;
  static constexpr int rounds = Colouring::colours + 2;

  SweptContacts<Real, Act::rubs> contacts;
  BodyView<Real> bodies;
  Act act;

  SIM_HD std::int64_t items(int round) const {
    if constexpr (requires { act.called_for(); })
      if (!act.called_for()) return 0;
    return read_only(round <= Colouring::colours ? contacts.count + round : contacts.split_bodies);
  }
  SIM_HD void operator()(int round, int item) const {
    const auto place = [&] { return read_only(contacts.begin + round) + static_cast<std::uint32_t>(item); };
    if (round < Colouring::colours)
      resolve(place());
    else if (round == Colouring::colours)
      resolve_split(place());
    else
      apply_split(item);
  }

  SIM_HD void resolve(std::uint32_t place) const {
    const Pair ids = contacts.bodies_of[place];
    SoftContact<Real> k = contacts.soft[place];
    const auto [w_a, w_b] = contacts.inverse_masses[place];
    Vector3<Real> v_a = bodies.velocity[ids.a], v_b = bodies.velocity[ids.b];
    if constexpr (Act::rubs) {
      // All is read before anything is computed: to wait for memory twice would cost more than what may turn
      // out to be of no use.
      SoftGrip<Real> grip = contacts.grips[place];
      RubbedPair<Real> pair(bodies, ids, k, contacts.gripped[place]);
      const bool pressed = press(place, ids, k, w_a, w_b, v_a, v_b);
      if (!(k.total > 0) && grip.impulse.dot(grip.impulse) == 0) {
        if (pressed) store(ids, v_a, v_b);
        return;
      }
      const Real mass = 1 / (w_a + w_b + pair.ease_a() + pair.ease_b());
      const Vector3<Real> rubbed = act.grip(k, grip, pair.slip(v_b - v_a), mass);
      contacts.grips[place] = grip;
      v_a -= w_a * rubbed;
      v_b += w_b * rubbed;
      pair.turn(bodies, ids, rubbed);
      bodies.angular_velocity[ids.a] = pair.rate_a;
      bodies.angular_velocity[ids.b] = pair.rate_b;
      store(ids, v_a, v_b);
    } else if (press(place, ids, k, w_a, w_b, v_a, v_b)) {
      store(ids, v_a, v_b);
    }
  }
  /// Whether it changed the velocities.
  SIM_HD bool press(std::uint32_t place, Pair ids, SoftContact<Real>& k, Real w_a, Real w_b,
                    Vector3<Real>& v_a, Vector3<Real>& v_b) const {
    const Real change = act.press(k, ids, v_b - v_a, 1 / (w_a + w_b));
    contacts.soft[place] = k;
    if (change == 0) return false;
    v_a -= change * w_a * k.normal;
    v_b += change * w_b * k.normal;
    return true;
  }
  SIM_HD void store(Pair ids, const Vector3<Real>& v_a, const Vector3<Real>& v_b) const {
    bodies.velocity[ids.a] = v_a;
    bodies.velocity[ids.b] = v_b;
  }

  SIM_HD void resolve_split(std::uint32_t place) const {
    const Pair ids = contacts.bodies_of[place];
    const Real n_a = static_cast<Real>(contacts.split.count[ids.a]),
               n_b = static_cast<Real>(contacts.split.count[ids.b]);
    const auto [w_a, w_b] = contacts.inverse_masses[place];
    const Vector3<Real> velocity = bodies.velocity[ids.b] - bodies.velocity[ids.a];
    SoftContact<Real>& k = contacts.soft[place];
    contacts.split_change[place] = act.press(k, ids, velocity, 1 / (w_a * n_a + w_b * n_b));
    if constexpr (Act::rubs) {
      const RubbedPair<Real> pair(bodies, ids, k, contacts.gripped[place]);
      const Real mass = 1 / ((w_a + pair.ease_a()) * n_a + (w_b + pair.ease_b()) * n_b);
      contacts.split_rubbed[place] = act.grip(k, contacts.grips[place], pair.slip(velocity), mass);
    }
  }

  /// A body's share of all its contacts in the set, added in increasing id of the other body.
  SIM_HD void apply_split(int body) const {
    const std::uint32_t n = contacts.split.count[body];
    if (n == 0) return;
    Vector3<Real> momentum = Vector3<Real>::Zero();
    [[maybe_unused]] Vector3<Real> moment = Vector3<Real>::Zero();
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t place = contacts.split.entry[contacts.split.begin[body] + k];
      const Real sign = contacts.bodies_of[place].a == static_cast<std::uint32_t>(body) ? Real(-1) : Real(1);
      const Vector3<Real> normal = contacts.soft[place].normal;
      momentum += sign * contacts.split_change[place] * normal;
      if constexpr (Act::rubs) {
        const Vector3<Real> rubbed = contacts.split_rubbed[place];
        momentum += sign * rubbed;
        moment -= (bodies.radius[body] + contacts.soft[place].gap / 2) * normal.cross(rubbed);
      }
    }
    bodies.velocity[body] += bodies.inverse_mass[body] * momentum;
    if constexpr (Act::rubs) {
      Spin<Real> spin = Spin<Real>::of(bodies, static_cast<std::uint32_t>(body));
      spin.turn(moment);
      bodies.angular_velocity[body] = spin.rate;
    }
  }
};

}  // namespace collidoscope
