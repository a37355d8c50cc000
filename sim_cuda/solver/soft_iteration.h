#pragma once
// One iteration of `soft_step` over all pairs of bodies in contact, colour by colour, then the mass-split
// set: the stages, and what they do with one contact. An act with has_friction also gives friction, after
// what it gives along the normal.
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
#include "sim_cuda/core/vector_load.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/contacts_by_body.h"
#include "sim_cuda/solver/friction_constraint.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {

// ---- acts: b moves at `velocity` relative to a, and `mass`, in kg, is what it works against; returns the
// impulse, N s. `sums`: changes what a contact remembers of the step ----

/// A speculative contact stops what would close its gap along today's normal, also of two that will fly past
/// each other. `with_ccd`: with continuous collision, which has many such, and keeps them apart should they
/// not: those are left alone.
///
/// `with_ccd` is a template parameter: as a run-time branch it costs 3 % of a step in double (50,000 bodies,
/// H200).
template <class Real, bool with_ccd>
struct Solve {
  static constexpr bool has_friction = false, sums = false;
  const Real* radius;  ///< m, by body; read only if `with_ccd`
  Softness<Real> softness;
  SIM_HD Real solve_normal(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity,
                           Real mass) const {
    if (with_ccd && contact.gap > 0 &&
        contact.passes(velocity, radius[bodies.a] + radius[bodies.b], 1 / softness.inverse_h)) {
      const Real change = -contact.impulse;
      contact.impulse = 0;
      return change;
    }
    return contact.template solve<true>(velocity.dot(contact.normal), mass, softness);
  }
};

template <class Real, bool with_friction>
struct Relax {
  static constexpr bool has_friction = with_friction, sums = true;
  Softness<Real> softness;
  const Real* radius;
  bool last;  ///< of the iterations of this substep
  Restitution<Real> restitution;
  std::uint32_t*
      bounces;  ///< null, but in the last iteration of a step: to be set where something will bounce
  SIM_HD Real solve_normal(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity,
                           Real mass) const {
    const Real change = contact.template solve<false>(velocity.dot(contact.normal), mass, softness);
    if (!last) return change;
    contact.end_substep(velocity, [&] { return radius[bodies.a] + radius[bodies.b]; });
    if (bounces != nullptr && contact.total > 0 && restitution.of_pair(bodies, contact.approach) > 0)
      atomic_store(bounces, std::uint32_t{1});
    return change;
  }
  SIM_HD Vector3<Real> solve_tangent(const SoftContact<Real>& contact, FrictionImpulse<Real>& friction,
                                     const Vector3<Real>& slip, Real mass) const {
    const Vector3<Real> change =
        solve_friction<Real>(slip, mass, friction.coefficient * contact.impulse, friction.impulse);
    if (last) friction.total += friction.impulse;
    return change;
  }
};

template <class Real>
struct Bounce {
  static constexpr bool has_friction = false, sums = true;
  Restitution<Real> restitution;
  const std::uint32_t* bounces;  ///< 0: nothing will bounce
  SIM_HD bool is_needed() const { return read_only(bounces) != 0; }
  SIM_HD Real solve_normal(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity,
                           Real mass) const {
    return contact.bounce(velocity.dot(contact.normal), mass, restitution.of_pair(bodies, contact.approach));
  }
};

/// Friction once more, where a contact bounced, within the normal impulse of the whole step.
template <class Real>
struct FrictionAfterBounce {
  static constexpr bool has_friction = true, sums = false;
  const std::uint32_t* bounces;
  SIM_HD bool is_needed() const { return read_only(bounces) != 0; }
  SIM_HD Real solve_normal(SoftContact<Real>&, Pair, const Vector3<Real>&, Real) const { return 0; }
  SIM_HD Vector3<Real> solve_tangent(const SoftContact<Real>& contact, FrictionImpulse<Real>& friction,
                                     const Vector3<Real>& slip, Real mass) const {
    if (!contact.bounced()) return Vector3<Real>::Zero();
    return solve_friction<Real>(slip, mass, friction.coefficient * contact.total, friction.total);
  }
};

// ---- one iteration ----

/// When a contact may be solved at its bodies a and b: how many contacts of a body come before it, and
/// the count that it leaves there, which is 0 after the last.
struct DependencyCounters {
  std::uint8_t a, b, next_a, next_b;

  /// `used`: the colours of a body's contacts, as bits.
  SIM_HD static std::uint8_t before(std::uint32_t used, int colour) {
    return static_cast<std::uint8_t>(count_bits(used & ((std::uint32_t{1} << colour) - 1)));
  }
  SIM_HD static std::uint8_t after(std::uint32_t used, int colour) {
    return used >> colour == 1 ? std::uint8_t{0} : static_cast<std::uint8_t>(before(used, colour) + 1);
  }
  SIM_HD static DependencyCounters of(std::uint32_t used_a, std::uint32_t used_b, int colour) {
    return {before(used_a, colour), before(used_b, colour), after(used_a, colour), after(used_b, colour)};
  }
};

/// The contacts of a step in the order in which they are solved: colour by colour, then the mass-split set. A
/// contact's place in it is not its number in the list of contacts.
template <class Real, bool with_friction>
struct OrderedContacts {
  const Pair* ids;
  const ContactBodies<Real>* bodies;
  PackedContact<Real>* soft;
  ContactSums<Real>* sums;
  FrictionSums<Real>* friction_sums;              ///< null without friction, as
  const ContactInertia<Real>* inertia;            ///< these
  const DependencyCounters* dependency_counters;  ///< of those with a colour
  const std::uint32_t* begin;              ///< where colour c starts; c = Colouring::colours: the split set
  const std::uint32_t* count;              ///< how many it has
  ContactsByBodyView uncoloured;           ///< places of the split set, by body
  const std::uint32_t* uncoloured_bodies;  ///< all bodies, or 0 where the set is empty
  Vector3<Real>* uncoloured_friction;      ///< N s, across the normal; null without friction
  Real* uncoloured_change;                 ///< N s, along it

  /// A contact, loaded with all that an iteration reads of it.
  struct LoadedContact {
    Pair ids;
    ContactBodies<Real> bodies;
    SoftContact<Real> contact;
    FrictionImpulse<Real> friction;  // this and the next: read only with friction
    ContactInertia<Real> inertia;
    std::uint32_t place;
  };
  SIM_HD LoadedContact load(std::uint32_t place) const {
    LoadedContact k;
    k.place = place;
    k.ids = ids[place];
    k.bodies = load_readonly(&bodies[place]);
    const PackedContact<Real> stored = load_cached(&soft[place]);
    const ContactSums<Real> sum = sums[place];
    k.contact = {stored.normal, stored.gap,   stored.impulse,
                 sum.total,     sum.approach, min_of(k.bodies.radius_a, k.bodies.radius_b)};
    if constexpr (with_friction) {
      const FrictionSums<Real> friction_sum = load_cached(&friction_sums[place]);
      k.friction = {stored.friction_impulse, friction_sum.total, friction_sum.coefficient};
      k.inertia = inertia[place];
    }
    return k;
  }
  /// `acted`: it gave something, or took it back.
  template <bool with_sums>
  SIM_HD void store(const LoadedContact& k, bool acted) const {
    if constexpr (with_sums) sums[k.place] = {k.contact.total, k.contact.approach};
    if (!acted) return;
    if constexpr (with_friction) {
      PackedContact<Real>::store_impulses(&soft[k.place], k.contact.impulse, k.friction.impulse);
      store_vectorized(&friction_sums[k.place], FrictionSums<Real>{k.friction.total, k.friction.coefficient});
    } else {
      soft[k.place].impulse = k.contact.impulse;
    }
  }
};

/// For Executor::run_rounds: a round for each colour, whose contacts share no body; then the mass-split set
/// (Tonge, Benevolenski, Voroshilov 2012), all at once: a body with n contacts in it counts as n bodies of
/// 1/n of its mass; then what they make of each body.
template <class Real, class Act>
struct Iteration {
  static constexpr bool static_item_counts = true;
  static constexpr int rounds = Colouring::colours + 2;

  OrderedContacts<Real, Act::has_friction> contacts;
  BodyView<Real> bodies;
  Act act;

  SIM_HD std::int64_t items(int round) const {
    if constexpr (requires { act.is_needed(); })
      if (!act.is_needed()) return 0;
    return read_only(round <= Colouring::colours ? contacts.count + round : contacts.uncoloured_bodies);
  }
  /// What a round reads of a contact, which nothing else in the iteration writes.
  using Operands = typename OrderedContacts<Real, Act::has_friction>::LoadedContact;
  static constexpr int prefetched_rounds = Colouring::colours;
  SIM_HD Operands fetch(int round, int item) const {
    return fetch(read_only(contacts.begin + round) + static_cast<std::uint32_t>(item));
  }
  SIM_HD Operands fetch(std::uint32_t place) const { return contacts.load(place); }
  SIM_HD void operator()(int round, int item) const {
    resolve_uncoloured(read_only(contacts.begin + round) + static_cast<std::uint32_t>(item));
  }
  SIM_HD void operator()(Operands k) const {
    Motion a = load(k.ids.a), b = load(k.ids.b);
    const bool acted = resolve(k, a, b);
    store(k.ids.a, a);
    store(k.ids.b, b);
    contacts.template store<Act::sums>(k, acted);
  }

  struct Motion {
    Vector3<Real> angular_velocity;  ///< rad/s; read only with friction
    Vector3<Real> v;                 ///< m/s
  };
  SIM_HD Motion load(std::uint32_t body) const {
    Motion motion;
    motion.v = bodies.velocity[body];
    if constexpr (Act::has_friction) motion.angular_velocity = bodies.angular_velocity[body];
    return motion;
  }
  SIM_HD void store(std::uint32_t body, const Motion& motion) const {
    bodies.velocity[body] = motion.v;
    if constexpr (Act::has_friction) bodies.angular_velocity[body] = motion.angular_velocity;
  }

  /// Whether it gave something, or took it back.
  SIM_HD bool resolve(Operands& k, Motion& a, Motion& b) const {
    const Real w_a = k.bodies.inverse_mass_a, w_b = k.bodies.inverse_mass_b;
    const Real change = act.solve_normal(k.contact, k.ids, b.v - a.v, 1 / (w_a + w_b));
    if (change != 0) {
      a.v -= change * w_a * k.contact.normal;
      b.v += change * w_b * k.contact.normal;
    }
    if constexpr (Act::has_friction) {
      if (!(k.contact.total > 0) && k.friction.impulse.dot(k.friction.impulse) == 0) return change != 0;
      FrictionConstraint<Real> pair(a.angular_velocity, b.angular_velocity, k.contact, k.bodies, k.inertia);
      const Real mass = 1 / (w_a + w_b + pair.angular_inverse_mass_a() + pair.angular_inverse_mass_b());
      const Vector3<Real> friction_impulse =
          act.solve_tangent(k.contact, k.friction, pair.slip(b.v - a.v), mass);
      a.v -= w_a * friction_impulse;
      b.v += w_b * friction_impulse;
      pair.apply_impulse(bodies, k.ids, friction_impulse);
      a.angular_velocity = pair.angular_velocity_a;
      b.angular_velocity = pair.angular_velocity_b;
      return true;
    }
    return change != 0;
  }

  // ---- on a GPU, in float: all colours without a pause ----

  static constexpr int sync_free_rounds = PackedVector3<Real>::has_tag ? Colouring::colours : 0;
  /// With friction, waiting for colours is sooner done where they have more contacts than there are threads:
  /// at 1,000,000 bodies `relax` takes 2.6 ms a step, and 2.9 ms with dependency counters.
  static constexpr bool sync_free_beyond_threads = !Act::has_friction;

  SIM_HD std::int64_t sync_free_items() const {
    if constexpr (requires { act.is_needed(); })
      if (!act.is_needed()) return 0;
    return read_only(contacts.begin + Colouring::colours);
  }
#if defined(__CUDACC__)
  /// Whether it was the contact's turn at both bodies, and is done.
  __device__ bool try_process(Operands& k) const {
    const DependencyCounters counters = contacts.dependency_counters[k.place];
    Motion a, b;
    if (!load_if_ready(k.ids.a, counters.a, a) || !load_if_ready(k.ids.b, counters.b, b)) return false;
    const bool acted = resolve(k, a, b);
    store_with_tag(k.ids.a, counters.next_a, a);
    store_with_tag(k.ids.b, counters.next_b, b);
    contacts.template store<Act::sums>(k, acted);
    return true;
  }
  __device__ bool load_if_ready(std::uint32_t body, std::uint32_t expected, Motion& motion) const {
    const auto [v, tag] = bodies.velocity[body].load_tagged();
    motion.v = v;
    if constexpr (Act::has_friction) {
      const auto [w, w_tag] = bodies.angular_velocity[body].load_tagged();
      motion.angular_velocity = w;
      return tag == expected && w_tag == expected;
    }
    return tag == expected;
  }
  __device__ void store_with_tag(std::uint32_t body, std::uint32_t tag, const Motion& motion) const {
    bodies.velocity[body].store_tagged(motion.v, tag);
    if constexpr (Act::has_friction) bodies.angular_velocity[body].store_tagged(motion.angular_velocity, tag);
  }
#endif

  SIM_HD void resolve_uncoloured(std::uint32_t place) const {
    Operands k = fetch(place);
    const Real n_a = static_cast<Real>(contacts.uncoloured.count[k.ids.a]),
               n_b = static_cast<Real>(contacts.uncoloured.count[k.ids.b]);
    const Real w_a = k.bodies.inverse_mass_a, w_b = k.bodies.inverse_mass_b;
    const Vector3<Real> velocity = bodies.velocity[k.ids.b].load() - bodies.velocity[k.ids.a].load();
    contacts.uncoloured_change[place] =
        act.solve_normal(k.contact, k.ids, velocity, 1 / (w_a * n_a + w_b * n_b));
    if constexpr (Act::has_friction) {
      const FrictionConstraint<Real> pair(bodies.angular_velocity[k.ids.a], bodies.angular_velocity[k.ids.b],
                                          k.contact, k.bodies, k.inertia);
      const Real mass =
          1 / ((w_a + pair.angular_inverse_mass_a()) * n_a + (w_b + pair.angular_inverse_mass_b()) * n_b);
      contacts.uncoloured_friction[place] =
          act.solve_tangent(k.contact, k.friction, pair.slip(velocity), mass);
    }
    contacts.template store<Act::sums>(k, true);
  }

  // ---- the last round: a body's share of all its contacts in the set, in increasing id of the other ----

  static constexpr int large_item_round = Colouring::colours + 1;
  SIM_HD void operator()(int body) const {
    const std::uint32_t n = contacts.uncoloured.count[body];
    if (n > 0) apply_uncoloured(body, ImpulseSums::accumulate(n, entry(body)));
  }
  SIM_HD bool is_large(int body) const { return contacts.uncoloured.count[body] > large_list_size; }
#if defined(__CUDACC__)
  __device__ void process_by_block(int body) const {
    const ImpulseSums impulses =
        ImpulseSums::accumulate_by_block(contacts.uncoloured.count[body], entry(body));
    if (threadIdx.x == 0) apply_uncoloured(body, impulses);
  }
#endif

 private:
  /// Momentum, with friction also across the normal, and moment.
  using ImpulseSums = std::conditional_t<Act::has_friction, OrderedSums<Real, 0, 0, 1>, OrderedSums<Real, 0>>;

  SIM_HD auto entry(int body) const {
    return [this, body](std::uint32_t k, Vector3<Real>* vectors) {
      const ContactEnd end = contacts.uncoloured.end(body, k);
      const std::uint32_t place = end.contact;
      const Real sign = end.sign<Real>();
      const Vector3<Real> normal = contacts.soft[place].normal;
      vectors[0] = sign * contacts.uncoloured_change[place] * normal;
      if constexpr (Act::has_friction) {
        const Vector3<Real> friction_impulse = contacts.uncoloured_friction[place];
        vectors[1] = sign * friction_impulse;
        vectors[2] = -((bodies.radius[body] + contacts.soft[place].gap / 2) * normal.cross(friction_impulse));
      }
    };
  }
  SIM_HD void apply_uncoloured(int body, const ImpulseSums& impulses) const {
    bodies.velocity[body] += bodies.inverse_mass[body] * impulses.sum[0];
    if constexpr (Act::has_friction) {
      AngularState<Real> angular = AngularState<Real>::of(bodies, static_cast<std::uint32_t>(body));
      angular.apply_angular_impulse(impulses.sum[1]);
      bodies.angular_velocity[body] = angular.velocity;
    }
  }
};

}  // namespace collidoscope
