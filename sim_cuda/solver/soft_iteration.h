#pragma once
// One iteration of `soft_step` over all contacts between bodies: colour by colour, then the mass-split set.
// Contains the stages and the acts (operations on one contact). Acts with has_friction also solve friction,
// after the normal impulse.
//
// On a GPU, an iteration has no barrier between colours. A tag beside each body's velocity counts its
// contacts that are done. A contact is solved when it is next at both its bodies. The order at each body is
// the order of the colours, so the result is the same bit for bit. (Liu et al. 2016, "A
// synchronization-free algorithm for parallel sparse triangular solves", replace level barriers in this
// way.)

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
#include "sim_cuda/solver/soft_contact.h"

namespace collidoscope {

/// Input of an act: the two bodies of a contact.
template <class Real>
struct Motions {
  Pair ids;
  const ContactBodies<Real>& bodies;
  Vector3<Real> v_a, v_b;  ///< m/s
  Real mass;               ///< effective mass, kg
  Real parts;              ///< effective mass of the whole bodies over `mass`: 1 unless the bodies are split
  SIM_HD Vector3<Real> velocity() const { return v_b - v_a; }  ///< of b relative to a
  SIM_HD Real reach() const { return bodies.radius_a + bodies.radius_b; }
};

// ---- acts: solve_normal() returns the change of the impulse, N s; finish() whether it has changed impulses
// after that. changes_sums(): the act has changed ContactSums ----

/// Soft solve of the normal constraint. Contacts that the bodies miss, or do not reach in the substep, get no
/// impulse.
template <class Real>
struct Solve {
  static constexpr bool has_friction = false;
  Softness<Real> softness;
  Real closing_gap;  ///< m
  bool first, last;  ///< first and last pass before the move
  SIM_HD Real solve_normal(SoftContact<Real>& contact, const Motions<Real>& motions) const {
    const Vector3<Real> velocity = motions.velocity();
    const Real speed = velocity.dot(contact.normal);
    if (contact.gap > 0) {
      // Most contacts without an impulse: the bodies do not touch in the substep.
      if (contact.impulse == 0 && speed + contact.gap * softness.inverse_h >= 0) return 0;
      const Real whole_mass = motions.mass * motions.parts;
      const Vector3<Real> without_impulse = velocity - contact.impulse / whole_mass * contact.normal;
      if (contact.passes(without_impulse, motions.reach(), 1 / softness.inverse_h)) {
        const Real change = -contact.impulse;
        contact.impulse = 0;
        return change;
      }
    }
    if (!(motions.parts > 1)) return contact.template solve<true>(speed, motions.mass, softness, first);
    const Real change =
        contact.template solve<true>(speed, motions.mass, softness.of_parts(motions.parts), first);
    return last ? change : contact.extend(change, softness.over_relaxation);
  }
  SIM_HD bool finish(SoftContact<Real>& contact, FrictionImpulse<Real>&) const {
    if (last) contact.mark_closing(closing_gap);
    return false;
  }
  SIM_HD bool changes_sums(const SoftContact<Real>& contact, bool) const {
    return last && contact.impact.is_closing();
  }
};

/// Rigid solve after the move, with friction. Contacts without an impulse stay inactive. `unequal_moments`:
/// of inertia. Kernels for them need more registers, so other scenes have their own.
template <class Real, bool with_friction, bool unequal_moments>
struct Relax {
  static constexpr bool has_friction = with_friction, has_unequal_moments = unequal_moments;
  Softness<Real> softness;
  bool last;  ///< last pass of this substep
  SIM_HD Real solve_normal(SoftContact<Real>& contact, const Motions<Real>& motions) const {
    contact.mark_pressing();
    const Real change =
        contact.template solve<false>(motions.velocity().dot(contact.normal), motions.mass, softness);
    return last || !(motions.parts > 1) ? change : contact.extend(change, softness.over_relaxation);
  }
  /// `mass`: effective mass, kg, or a TangentResponse.
  template <class Mass>
  SIM_HD Vector3<Real> solve_tangent(const SoftContact<Real>& contact, FrictionImpulse<Real>& friction,
                                     const Vector3<Real>& slip, const Mass& mass) const {
    if (last) friction.impact = Vector3<Real>::Zero();
    return solve_friction<Real>(slip, mass, friction.coefficient * contact.impulse, friction.impulse);
  }
  /// Whether to solve friction, after the normal impulse changed by the last argument.
  SIM_HD bool has_tangent(const SoftContact<Real>& contact, const FrictionImpulse<Real>& friction,
                          Real) const {
    return contact.total > 0 || (last && contact.impulse > 0) || friction.impulse.dot(friction.impulse) != 0;
  }
  SIM_HD bool finish(SoftContact<Real>& contact, FrictionImpulse<Real>& friction) const {
    if (!last || !contact.end_substep()) return false;
    friction.impulse = Vector3<Real>::Zero();
    return true;
  }
  SIM_HD bool changes_sums(const SoftContact<Real>& contact, bool acted) const {
    return last || acted || contact.impulse > 0;
  }
};

// ---- one iteration ----

/// The contacts of a step in solve order: colour by colour, then the mass-split set. The place of a contact
/// is its index in this order; its number is its index in the contact list.
template <class Real, bool with_friction>
struct OrderedContacts {
  const Pair* ids;
  const ContactBodies<Real>* bodies;
  PackedContact<Real>* soft;
  ContactSums<Real>* sums;
  FrictionSums<Real>* friction_sums;              ///< null without friction
  const ContactInertia<Real>* inertia;            ///< null without friction
  const DependencyCounters* dependency_counters;  ///< for coloured contacts
  const std::uint32_t* begin;              ///< start of colour c; c = Colouring::colours: mass-split set
  const std::uint32_t* count;              ///< number of contacts of colour c
  ContactsByBodyView uncoloured;           ///< places of the mass-split contacts, by body
  const std::uint32_t* uncoloured_bodies;  ///< number of bodies, or 0 if the set is empty
  Vector3<Real>* uncoloured_friction;      ///< change of friction impulse, N s; null without friction
  Real* uncoloured_change;                 ///< change of normal impulse, N s

  /// All data of a contact that an iteration reads.
  struct LoadedContact {
    Pair ids;
    ContactBodies<Real> bodies;
    SoftContact<Real> contact;
    FrictionImpulse<Real> friction;  // this and inertia: only with friction
    ContactInertia<Real> inertia;
    std::uint32_t place;
  };
  SIM_HD LoadedContact load(std::uint32_t place) const {
    LoadedContact k;
    k.place = place;
    k.ids = ids[place];
    k.bodies = load_readonly(&bodies[place]);
    const auto& stored = load_cached(&soft[place]);
    const ContactSums<Real> sum = sums[place];
    k.contact = {stored.normal, stored.gap, stored.impulse,
                 sum.total,     sum.impact, min_of(k.bodies.radius_a, k.bodies.radius_b)};
    if constexpr (with_friction) {
      const auto& friction_sum = load_cached(&friction_sums[place]);
      k.friction = {stored.friction_impulse, friction_sum.impact, friction_sum.coefficient};
      k.inertia = inertia[place];
    }
    return k;
  }
  /// `acted`: an impulse has changed. `with_sums`: ContactSums may have changed.
  SIM_HD void store(const LoadedContact& k, bool acted, bool with_sums) const {
    if (with_sums) sums[k.place] = {k.contact.total, k.contact.impact};
    if (!acted) return;
    if constexpr (with_friction) {
      PackedContact<Real>::store_impulses(&soft[k.place], k.contact.impulse, k.friction.impulse);
      store_vectorized(&friction_sums[k.place],
                       FrictionSums<Real>{k.friction.impact, k.friction.coefficient});
    } else {
      soft[k.place].impulse = k.contact.impulse;
    }
  }
};

/// For Executor::run_rounds. One round per colour; then one round for the mass-split set (Tonge,
/// Benevolenski, Voroshilov 2012), all contacts in parallel; then one round that applies its sums to the
/// bodies. A body with n contacts in the set is split into n parts of 1/n of its mass.
template <class Real, class Act>
struct Iteration {
  static constexpr bool static_item_counts = true;
  static constexpr int rounds = Colouring::colours + 2;
  static constexpr bool has_unequal_moments() {
    if constexpr (requires { Act::has_unequal_moments; }) return Act::has_unequal_moments;
    return false;
  }

  OrderedContacts<Real, Act::has_friction> contacts;
  BodyView<Real> bodies;
  Act act;

  SIM_HD std::int64_t items(int round) const {
    if constexpr (requires { act.is_needed(); })
      if (!act.is_needed()) return 0;
    return read_only(round <= Colouring::colours ? contacts.count + round : contacts.uncoloured_bodies);
  }
  /// Data of a contact that no other item of the iteration writes.
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
    if constexpr (requires { Act::mostly_idle; }) {
      if (!acted) return;
      act.mark(k.ids, k.bodies, a.v, b.v);
    }
    store(k.ids.a, a);
    store(k.ids.b, b);
    contacts.store(k, acted, act.changes_sums(k.contact, acted));
  }

  struct Motion {
    Vector3<Real> angular_velocity;  ///< rad/s; used only with friction
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

  /// Solves a contact. Returns true if an impulse has changed.
  SIM_HD bool resolve(Operands& k, Motion& a, Motion& b) const {
    const bool acted = resolve_impulses(k, a, b);
    return act.finish(k.contact, k.friction) || acted;
  }
  SIM_HD bool resolve_impulses(Operands& k, Motion& a, Motion& b) const {
    if constexpr (requires { Act::mostly_idle; })
      if (act.shock(k.contact, k.ids, k.bodies, a.v, b.v)) return true;
    const Real w_a = k.bodies.inverse_mass_a, w_b = k.bodies.inverse_mass_b;
    const Real change =
        act.solve_normal(k.contact, Motions<Real>{k.ids, k.bodies, a.v, b.v, 1 / (w_a + w_b), 1});
    if (change != 0) {
      a.v -= change * w_a * k.contact.normal;
      b.v += change * w_b * k.contact.normal;
    }
    if constexpr (Act::has_friction) {
      if (!act.has_tangent(k.contact, k.friction, change)) return change != 0;
      FrictionConstraint<Real> pair(a.angular_velocity, b.angular_velocity, k.contact, k.bodies, k.inertia);
      const auto solve = [&](const auto& mass) {
        return act.solve_tangent(k.contact, k.friction, pair.slip(b.v - a.v), mass);
      };
      const auto of_equal_moments = [&] {
        return solve(1 / (w_a + w_b + pair.angular_inverse_mass_a() + pair.angular_inverse_mass_b()));
      };
      Vector3<Real> friction_impulse;
      if constexpr (has_unequal_moments())
        friction_impulse =
            pair.is_isotropic() ? of_equal_moments() : solve(pair.response(bodies, k.ids, w_a + w_b));
      else
        friction_impulse = of_equal_moments();
      a.v -= w_a * friction_impulse;
      b.v += w_b * friction_impulse;
      pair.apply_impulse(bodies, k.ids, friction_impulse);
      a.angular_velocity = pair.angular_velocity_a;
      b.angular_velocity = pair.angular_velocity_b;
      return true;
    }
    return change != 0;
  }

  // ---- on a GPU, in float: all colours without a barrier ----

  static constexpr int sync_free_rounds =
      PackedVector3<Real>::has_tag && !has_unequal_moments() ? Colouring::colours : 0;
  /// With friction, barriers between colours are faster if a colour has more contacts than there are
  /// threads. At 1,000,000 bodies `relax` takes 2.6 ms per step, and 2.9 ms with dependency counters.
  static constexpr bool sync_free_beyond_threads = !Act::has_friction;

  SIM_HD std::int64_t sync_free_items() const {
    if constexpr (requires { act.is_needed(); })
      if (!act.is_needed()) return 0;
    return read_only(contacts.begin + Colouring::colours);
  }
#if defined(__CUDACC__)
  /// Solves the contact if it is next at both bodies. Returns true if it was solved.
  __device__ bool try_process(Operands& k) const {
    const DependencyCounters counters = contacts.dependency_counters[k.place];
    Motion a, b;
    if (!load_if_ready(k.ids.a, counters.a, a) || !load_if_ready(k.ids.b, counters.b, b)) return false;
    const bool acted = resolve(k, a, b);
    store_with_tag(k.ids.a, counters.next_a, a);
    store_with_tag(k.ids.b, counters.next_b, b);
    if constexpr (requires { Act::mostly_idle; }) {
      if (!acted) return true;
      act.mark(k.ids, k.bodies, a.v, b.v);  // for later sweeps
    }
    contacts.store(k, acted, act.changes_sums(k.contact, acted));
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
    const Vector3<Real> v_a = bodies.velocity[k.ids.a], v_b = bodies.velocity[k.ids.b], velocity = v_b - v_a;
    const Real w = w_a * n_a + w_b * n_b;  // of the parts
    const Real change =
        act.solve_normal(k.contact, Motions<Real>{k.ids, k.bodies, v_a, v_b, 1 / w, w / (w_a + w_b)});
    contacts.uncoloured_change[place] = change;
    if constexpr (requires { Act::mostly_idle; })
      if (change != 0) act.mark(k.ids, k.bodies, v_a, v_b);
    if constexpr (Act::has_friction) {
      Vector3<Real>& friction_change = contacts.uncoloured_friction[place];
      friction_change = Vector3<Real>::Zero();
      if (act.has_tangent(k.contact, k.friction, change)) {
        const FrictionConstraint<Real> pair(bodies.angular_velocity[k.ids.a],
                                            bodies.angular_velocity[k.ids.b], k.contact, k.bodies, k.inertia);
        const auto solve = [&](const auto& mass) {
          return act.solve_tangent(k.contact, k.friction, pair.slip(velocity), mass);
        };
        const auto of_equal_moments = [&] {
          return solve(1 / ((w_a + pair.angular_inverse_mass_a()) * n_a +
                            (w_b + pair.angular_inverse_mass_b()) * n_b));
        };
        if constexpr (has_unequal_moments())
          friction_change = pair.is_isotropic()
                                ? of_equal_moments()
                                : solve(pair.response(bodies, k.ids, w_a * n_a + w_b * n_b, n_a, n_b));
        else
          friction_change = of_equal_moments();
      }
    }
    act.finish(k.contact, k.friction);
    contacts.store(k, true, act.changes_sums(k.contact, true));
  }

  // ---- last round: sum of a body's contacts in the set, in increasing id of the other body ----

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
  /// Sums: momentum, with friction included, and moment.
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
