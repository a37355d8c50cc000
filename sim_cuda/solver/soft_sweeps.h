#pragma once
// One sweep of `soft_step` over all pairs of bodies in contact, colour by colour, then the mass-split set:
// the stages, and what they do with one contact. An act that rubs also gives friction, after what it gives
// along the normal.
//
// On a GPU nobody waits for a colour to be done: beside a body's velocity stands how many of its contacts
// have been, and a contact goes ahead when it is the next at both its bodies. The order at each body is that
// of the colours, so the result is the same to the bit (as Liu et al. 2016, "A synchronization-free algorithm
// for parallel sparse triangular solves", do away with levels).

#include <cstdint>
#include <type_traits>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/block.h"
#include "sim_cuda/core/ordered_sums.h"
#include "sim_cuda/core/whole_record.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/soft_contact.h"
#include "sim_cuda/solver/soft_grip.h"
#include "sim_cuda/solver/soft_memory.h"

namespace collidoscope {

// ---- acts: b moves at `velocity` relative to a, and `mass`, in kg, is what it works against; returns the
// impulse, N s. `sums`: changes what a contact remembers of the step ----

/// A foreseen contact stops what would close its gap along today's normal, also of two that will fly past
/// each other. `held`: with continuous collision, which foresees many such, and keeps them apart should they
/// not: those are left alone.
///
/// `held` is a template parameter: as a run-time branch it costs 3 % of a step in double (50,000 bodies,
/// H200).
template <class Real, bool held>
struct Solve {
  static constexpr bool rubs = false, sums = false;
  const Real* radius;  ///< m, by body; read only if `held`
  Softness<Real> softness;
  SIM_HD Real press(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity, Real mass) const {
    if (held && contact.gap > 0 &&
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
  static constexpr bool rubs = friction, sums = true;
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
  static constexpr bool rubs = false, sums = true;
  Restitution<Real> restitution;
  const std::uint32_t* bounces;  ///< 0: nothing will bounce
  SIM_HD bool required() const { return read_only(bounces) != 0; }
  SIM_HD Real press(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity, Real mass) const {
    return contact.bounce(velocity.dot(contact.normal), mass, restitution.of_pair(bodies, contact.approach));
  }
};

/// Friction once more, where a contact bounced, within what the whole step has pressed.
template <class Real>
struct Grip {
  static constexpr bool rubs = true, sums = false;
  const std::uint32_t* bounces;
  SIM_HD bool required() const { return read_only(bounces) != 0; }
  SIM_HD Real press(SoftContact<Real>&, Pair, const Vector3<Real>&, Real) const { return 0; }
  SIM_HD Vector3<Real> grip(const SoftContact<Real>& contact, SoftGrip<Real>& grip, const Vector3<Real>& slip,
                            Real mass) const {
    if (!contact.bounced()) return Vector3<Real>::Zero();
    return rub<Real>(slip, mass, grip.coefficient * contact.total, grip.total);
  }
};

// ---- one sweep ----

/// When it is the turn of a contact at its bodies a and b: how many contacts of a body come before it, and
/// the count that it leaves there, which is 0 after the last.
struct Turns {
  std::uint8_t a, b, next_a, next_b;

  /// `used`: the colours of a body's contacts, as bits.
  SIM_HD static std::uint8_t before(std::uint32_t used, int colour) {
    return static_cast<std::uint8_t>(bits_set(used & ((std::uint32_t{1} << colour) - 1)));
  }
  SIM_HD static std::uint8_t after(std::uint32_t used, int colour) {
    return used >> colour == 1 ? std::uint8_t{0} : static_cast<std::uint8_t>(before(used, colour) + 1);
  }
  SIM_HD static Turns of(std::uint32_t used_a, std::uint32_t used_b, int colour) {
    return {before(used_a, colour), before(used_b, colour), after(used_a, colour), after(used_b, colour)};
  }
};

/// The contacts of a step in the order in which they are swept: colour by colour, then the mass-split set. A
/// contact's place in it is not its number in the list of contacts.
template <class Real, bool rubbed>
struct SweptContacts {
  const Pair* ids;
  const ContactBodies<Real>* bodies;
  StoredContact<Real>* soft;
  ContactSums<Real>* sums;
  GripSums<Real>* grips;              ///< null without friction, as
  const TurnedBodies<Real>* turned;   ///< these
  const Turns* turns;                 ///< of those with a colour
  const std::uint32_t* begin;         ///< where colour c starts; c = Colouring::colours: the split set
  const std::uint32_t* count;         ///< how many it has
  ContactsByBodyView split;           ///< places of the split set, by body
  const std::uint32_t* split_bodies;  ///< all bodies, or 0 where the set is empty
  Vector3<Real>* split_rubbed;        ///< N s, across the normal; null without friction
  Real* split_change;                 ///< N s, along it

  /// A contact, and what a sweep knows with it.
  struct Known {
    Pair ids;
    ContactBodies<Real> bodies;
    SoftContact<Real> contact;
    SoftGrip<Real> grip;  // this and the next: read only with friction
    TurnedBodies<Real> turned;
    std::uint32_t place;
  };
  SIM_HD Known load(std::uint32_t place) const {
    Known k;
    k.place = place;
    k.ids = ids[place];
    k.bodies = load_whole(&bodies[place]);
    const StoredContact<Real> stored = load_own(&soft[place]);
    const ContactSums<Real> sum = sums[place];
    k.contact = {stored.normal, stored.gap,   stored.impulse,
                 sum.total,     sum.approach, min_of(k.bodies.radius_a, k.bodies.radius_b)};
    if constexpr (rubbed) {
      const GripSums<Real> grip_sums = load_own(&grips[place]);
      k.grip = {stored.rubbed, grip_sums.total, grip_sums.coefficient};
      k.turned = turned[place];
    }
    return k;
  }
  /// `acted`: it gave something, or took it back.
  template <bool summed>
  SIM_HD void store(const Known& k, bool acted) const {
    if constexpr (summed) sums[k.place] = {k.contact.total, k.contact.approach};
    if (!acted) return;
    if constexpr (rubbed) {
      StoredContact<Real>::store_impulses(&soft[k.place], k.contact.impulse, k.grip.impulse);
      store_whole(&grips[k.place], GripSums<Real>{k.grip.total, k.grip.coefficient});
    } else {
      soft[k.place].impulse = k.contact.impulse;
    }
  }
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
    if constexpr (requires { act.required(); })
      if (!act.required()) return 0;
    return read_only(round <= Colouring::colours ? contacts.count + round : contacts.split_bodies);
  }
  /// What a round reads of a contact, which nothing else in the sweep writes.
  using Fetched = typename SweptContacts<Real, Act::rubs>::Known;
  static constexpr int fetched = Colouring::colours;
  SIM_HD Fetched fetch(int round, int item) const {
    return fetch(read_only(contacts.begin + round) + static_cast<std::uint32_t>(item));
  }
  SIM_HD Fetched fetch(std::uint32_t place) const { return contacts.load(place); }
  SIM_HD void operator()(int round, int item) const {
    resolve_split(read_only(contacts.begin + round) + static_cast<std::uint32_t>(item));
  }
  SIM_HD void operator()(Fetched k) const {
    Motion a = load(k.ids.a), b = load(k.ids.b);
    const bool acted = resolve(k, a, b);
    store(k.ids.a, a);
    store(k.ids.b, b);
    contacts.template store<Act::sums>(k, acted);
  }

  struct Motion {
    Vector3<Real> spin;  ///< rad/s; read only with friction
    Vector3<Real> v;     ///< m/s
  };
  SIM_HD Motion load(std::uint32_t body) const {
    Motion motion;
    motion.v = bodies.velocity[body];
    if constexpr (Act::rubs) motion.spin = bodies.angular_velocity[body];
    return motion;
  }
  SIM_HD void store(std::uint32_t body, const Motion& motion) const {
    bodies.velocity[body] = motion.v;
    if constexpr (Act::rubs) bodies.angular_velocity[body] = motion.spin;
  }

  /// Whether it gave something, or took it back.
  SIM_HD bool resolve(Fetched& k, Motion& a, Motion& b) const {
    const Real w_a = k.bodies.inverse_mass_a, w_b = k.bodies.inverse_mass_b;
    const Real change = act.press(k.contact, k.ids, b.v - a.v, 1 / (w_a + w_b));
    if (change != 0) {
      a.v -= change * w_a * k.contact.normal;
      b.v += change * w_b * k.contact.normal;
    }
    if constexpr (Act::rubs) {
      if (!(k.contact.total > 0) && k.grip.impulse.dot(k.grip.impulse) == 0) return change != 0;
      RubbedPair<Real> pair(a.spin, b.spin, k.contact, k.bodies, k.turned);
      const Real mass = 1 / (w_a + w_b + pair.ease_a() + pair.ease_b());
      const Vector3<Real> rubbed = act.grip(k.contact, k.grip, pair.slip(b.v - a.v), mass);
      a.v -= w_a * rubbed;
      b.v += w_b * rubbed;
      pair.turn(bodies, k.ids, rubbed);
      a.spin = pair.rate_a;
      b.spin = pair.rate_b;
      return true;
    }
    return change != 0;
  }

  // ---- on a GPU, in float: all colours without a pause ----

  static constexpr int chained = StoredVector3<Real>::counts ? Colouring::colours : 0;
  /// With friction, waiting for colours is sooner done where they have more contacts than there are threads:
  /// at 1,000,000 bodies `relax` takes 2.6 ms a step, and 2.9 ms by turns.
  static constexpr bool chained_beyond_threads = !Act::rubs;

  SIM_HD std::int64_t chained_items() const {
    if constexpr (requires { act.required(); })
      if (!act.required()) return 0;
    return read_only(contacts.begin + Colouring::colours);
  }
#if defined(__CUDACC__)
  /// Whether it was the contact's turn at both bodies, and is done.
  __device__ bool take_turn(Fetched& k) const {
    const Turns turns = contacts.turns[k.place];
    Motion a, b;
    if (!take(k.ids.a, turns.a, a) || !take(k.ids.b, turns.b, b)) return false;
    const bool acted = resolve(k, a, b);
    give(k.ids.a, turns.next_a, a);
    give(k.ids.b, turns.next_b, b);
    contacts.template store<Act::sums>(k, acted);
    return true;
  }
  __device__ bool take(std::uint32_t body, std::uint32_t turn, Motion& motion) const {
    const auto [v, at] = bodies.velocity[body].take();
    motion.v = v;
    if constexpr (Act::rubs) {
      const auto [spin, spin_at] = bodies.angular_velocity[body].take();
      motion.spin = spin;
      return at == turn && spin_at == turn;
    }
    return at == turn;
  }
  __device__ void give(std::uint32_t body, std::uint32_t turn, const Motion& motion) const {
    bodies.velocity[body].give(motion.v, turn);
    if constexpr (Act::rubs) bodies.angular_velocity[body].give(motion.spin, turn);
  }
#endif

  SIM_HD void resolve_split(std::uint32_t place) const {
    Fetched k = fetch(place);
    const Real n_a = static_cast<Real>(contacts.split.count[k.ids.a]),
               n_b = static_cast<Real>(contacts.split.count[k.ids.b]);
    const Real w_a = k.bodies.inverse_mass_a, w_b = k.bodies.inverse_mass_b;
    const Vector3<Real> velocity = bodies.velocity[k.ids.b].load() - bodies.velocity[k.ids.a].load();
    contacts.split_change[place] = act.press(k.contact, k.ids, velocity, 1 / (w_a * n_a + w_b * n_b));
    if constexpr (Act::rubs) {
      const RubbedPair<Real> pair(bodies.angular_velocity[k.ids.a], bodies.angular_velocity[k.ids.b],
                                  k.contact, k.bodies, k.turned);
      const Real mass = 1 / ((w_a + pair.ease_a()) * n_a + (w_b + pair.ease_b()) * n_b);
      contacts.split_rubbed[place] = act.grip(k.contact, k.grip, pair.slip(velocity), mass);
    }
    contacts.template store<Act::sums>(k, true);
  }

  // ---- the last round: a body's share of all its contacts in the set, in increasing id of the other ----

  static constexpr int long_round = Colouring::colours + 1;
  SIM_HD void operator()(int body) const {
    const std::uint32_t n = contacts.split.count[body];
    if (n > 0) apply_split(body, Given::over(n, entry(body)));
  }
  SIM_HD bool is_long(int body) const { return contacts.split.count[body] > long_list; }
#if defined(__CUDACC__)
  __device__ void together(int body) const {
    const Given given = Given::over_together(contacts.split.count[body], entry(body));
    if (threadIdx.x == 0) apply_split(body, given);
  }
#endif

 private:
  /// Momentum, with friction also across the normal, and moment.
  using Given = std::conditional_t<Act::rubs, OrderedSums<Real, 0, 0, 1>, OrderedSums<Real, 0>>;

  SIM_HD auto entry(int body) const {
    return [this, body](std::uint32_t k, Vector3<Real>* given) {
      const ContactEnd end = contacts.split.end(body, k);
      const std::uint32_t place = end.contact;
      const Real sign = end.sign<Real>();
      const Vector3<Real> normal = contacts.soft[place].normal;
      given[0] = sign * contacts.split_change[place] * normal;
      if constexpr (Act::rubs) {
        const Vector3<Real> rubbed = contacts.split_rubbed[place];
        given[1] = sign * rubbed;
        given[2] = -((bodies.radius[body] + contacts.soft[place].gap / 2) * normal.cross(rubbed));
      }
    };
  }
  SIM_HD void apply_split(int body, const Given& given) const {
    bodies.velocity[body] += bodies.inverse_mass[body] * given.sum[0];
    if constexpr (Act::rubs) {
      Spin<Real> spin = Spin<Real>::of(bodies, static_cast<std::uint32_t>(body));
      spin.turn(given.sum[1]);
      bodies.angular_velocity[body] = spin.rate;
    }
  }
};

}  // namespace collidoscope
