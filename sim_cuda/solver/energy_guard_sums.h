#pragma once
// Sums of the energy guard (energy_guard.h) over the islands: energy terms, and rigid motions. Sums are sums
// of integers, in units of the largest term of the island, so that they do not depend on the order.

#include <bit>
#include <cstdint>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/disjoint_sets.h"
#include "sim_cuda/solver/energy_guard_bodies.h"
#include "sim_cuda/solver/rigid_motion.h"

namespace collidoscope {

template <class Real>
struct GuardSums : GuardedBodies<Real> {
  using Bodies = GuardedBodies<Real>;
  using Bodies::angular_state, Bodies::bodies, Bodies::body_count, Bodies::change_of,
      Bodies::free_angular_velocity, Bodies::free_velocity, Bodies::gain, Bodies::moved, Bodies::opposing_of,
      Bodies::start, Bodies::start_spin, Bodies::wide, Bodies::work_angular_velocity, Bodies::work_velocity;
  using typename Bodies::Change;
  std::uint32_t *parent, *scale;
  EnergyTerms* terms_of;            ///< by body
  ContactChange<Real>* changes;     ///< by body: what a removal takes a share from
  std::uint64_t* sums;              ///< by root: see EnergyTerms; partial sums by first body of a group
  std::uint8_t *exempt, *grounded;  ///< by body, then by root
  std::uint8_t* active;             ///< by body: 1 + the next removal of its island, or 0
  std::uint32_t* rigid_scale;       ///< by root and kind: bits of the largest value (float)
  std::uint64_t* rigid_sums;        ///< by root: RigidSums, in units of the largest value of a kind
  float* load_factor;               ///< by root: factor of the impulses for warm starting, or null
  bool slow_keep_loads;             ///< loads of slow islands are reduced less, see GuardRounds::full_motion

  /// Removals: impulses at the end of the substep, steps of steepest descent, motion relative to the rigid
  /// motion.
  static constexpr int removals = EnergyGuard<Real>::removals;
  /// Bodies whose terms are added together before they are added to the sum of the island.
  static constexpr int group = 1024;
  SIM_HD static bool is_rigid(int removal) { return removal == removals - 1; }

  SIM_HD bool is_active(int removal, std::uint32_t body) const {
    return atomic_load(&active[body]) == removal + 1;
  }
  /// True if the body's island touches planes or static bodies.
  SIM_HD bool is_grounded(int body) const {
    return grounded[root_of(parent, static_cast<std::uint32_t>(body))] != 0;
  }

  /// Calls `act` for the bodies of a group.
  template <class Act>
  SIM_HD void for_each_body(int number, const Act& act) const {
    const int first = number * group;
    for (int body = first; body < body_count && body < first + group; ++body) act(body);
  }

  // ---- rigid motions, then energies ----

  /// Bits of a term in RigidSums: as many as the sum of all bodies allows, at most those of a double.
  /// Momentum is conserved to the rounding of these sums.
  SIM_HD int rigid_bits() const {
    int terms = 1;
    while (terms < 24 && body_count >> terms != 0) ++terms;
    return min_of(62 - terms, 52);
  }
  SIM_HD static std::size_t at(std::int64_t root, std::uint32_t k, std::uint32_t count) {
    return static_cast<std::size_t>(root) * count + k;
  }
  /// Terms of a body in the sums of its island. The origin is the body `root`, with its velocity of the move,
  /// which does not change here.
  SIM_HD RigidSums rigid_terms(int body, std::uint32_t root) const {
    RigidSums terms;
    terms.add(static_cast<double>(bodies.mass[body]),
              wide(bodies.position[body]) - wide(bodies.position[root]),
              wide(bodies.velocity[body]) - wide(moved[root]));
    if (start_spin != nullptr)
      terms.add_rotation(wide(bodies.inertia[body]), widened<Real>(bodies.orientation[body]),
                         wide(bodies.angular_velocity[body]));
    return terms;
  }
  SIM_HD void find_rigid_scale(int body) const {
    if (!is_active(removals - 1, static_cast<std::uint32_t>(body))) return;
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    const RigidSums terms = rigid_terms(body, root);
    for (std::uint32_t kind = 0; kind < RigidSums::kinds; ++kind) {
      const float size = static_cast<float>(terms.largest(kind));
      if (is_finite(size) && size > 0)
        atomic_max(&rigid_scale[at(root, kind, RigidSums::kinds)], std::bit_cast<std::uint32_t>(size));
    }
  }
  /// Terms of a body in units of the sums of its island. Returns false if there are none.
  struct RigidUnits {
    const GuardSums& of;
    SIM_HD bool operator()(int body, std::uint32_t root, std::uint64_t (&units)[RigidSums::count]) const {
      const RigidSums terms = of.rigid_terms(body, root);
      const int bits = of.rigid_bits();
      for (std::uint32_t k = 0; k < RigidSums::count; ++k) {
        const std::uint32_t scale_bits = of.rigid_scale[at(root, RigidSums::kind_of(k), RigidSums::kinds)];
        if (scale_bits != 0) units[k] = in_units(terms.values[k], unit_of_sum(scale_bits, bits), bits);
      }
      return true;
    }
  };
  struct EnergyUnits {
    const GuardSums& of;
    SIM_HD bool operator()(int body, std::uint32_t root, std::uint64_t (&units)[EnergyTerms::count]) const {
      if (of.scale[root] == 0) return false;
      const EnergyTerms terms = of.terms_of[body];
      const double one = unit_of_sum(of.scale[root]);
      for (std::uint32_t k = 0; k < EnergyTerms::count; ++k) units[k] = in_units(terms.values[k], one);
      return true;
    }
  };
  SIM_HD void find_scale(int removal, int body) const {
    if (!is_active(removal, static_cast<std::uint32_t>(body))) return;
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    if (exempt[root] != 0) return;
    const EnergyTerms sum = terms_of[body] = terms(removal, body);
    const float size = static_cast<float>(sum.largest());
    if (is_finite(size) && size > 0) atomic_max(&scale[root], std::bit_cast<std::uint32_t>(size));
  }
  /// Adds the terms of a body to the sums of its island. `item`: the body, or its group on the CPU.
  template <std::uint32_t count, class UnitsOf>
  SIM_HD void add_terms(int removal, std::uint64_t* sums_by_body, int item, const UnitsOf& units_of) const {
#if defined(__CUDA_ARCH__)
    const auto id = static_cast<std::uint32_t>(item);
    if (!is_active(removal, id)) return;
    const std::uint32_t root = root_of(parent, id);
    std::uint64_t units[count] = {};
    if (units_of(item, root, units))
      atomic_add_aggregated(&sums_by_body[at(place_of_sum(item, root), 0, count)], units);
#else
    std::uint64_t sum[count] = {};
    std::uint32_t place = 0;
    for_each_body(item, [&](int body) {
      const auto id = static_cast<std::uint32_t>(body);
      if (!is_active(removal, id)) return;
      const std::uint32_t root = root_of(parent, id);
      std::uint64_t units[count] = {};
      if (!units_of(body, root, units)) return;
      const std::uint32_t next = place_of_sum(body, root);
      if (next != place) {
        atomic_add_aggregated(&sums_by_body[at(place, 0, count)], sum);
        for (std::uint64_t& value : sum) value = 0;
        place = next;
      }
      for (std::uint32_t k = 0; k < count; ++k) sum[k] += units[k];
    });
    atomic_add_aggregated(&sums_by_body[at(place, 0, count)], sum);
#endif
  }
  /// The body at whose place the term of a body is added: the first of its group if that is in the same
  /// island, else the root. On a GPU, atomics at the root of a large island are a bottleneck.
  SIM_HD std::uint32_t place_of_sum(int body, std::uint32_t root) const {
    const auto first = static_cast<std::uint32_t>(body / group * group);
    return atomic_load(&active[first]) != 0 && root_of(parent, first) == root ? first : root;
  }
  /// Adds the sums of a group to those of the island.
  template <std::uint32_t count>
  SIM_HD void gather(int removal, std::uint64_t* sums_by_body, int number) const {
    const auto first = static_cast<std::uint32_t>(number * group);
    if (!is_active(removal, first)) return;
    const std::uint32_t root = root_of(parent, first);
    if (root == first) return;
    for (std::uint32_t k = 0; k < count; ++k)
      if (sums_by_body[at(first, k, count)] != 0)
        atomic_add(&sums_by_body[at(root, k, count)], sums_by_body[at(first, k, count)]);
  }

  SIM_HD void add_rigid(int removal, int item) const {
    add_terms<RigidSums::count>(removal, rigid_sums, item, RigidUnits{*this});
  }
  SIM_HD void add_energies(int removal, int item) const {
    add_terms<EnergyTerms::count>(removal, sums, item, EnergyUnits{*this});
  }
  SIM_HD void gather_rigid(int removal, int group_number) const {
    gather<RigidSums::count>(removal, rigid_sums, group_number);
  }
  SIM_HD void gather_energies(int removal, int group_number) const {
    gather<EnergyTerms::count>(removal, sums, group_number);
  }

  // ---- terms ----

  SIM_HD EnergyTerms terms(int removal, int body) const {
    EnergyTerms sum = gain(body);
    const Change removed = changes[body] = removed_of(removal, body);
    const Vector3<double> impulse = wide(removed.impulse);
    sum.values[3] = work_velocity(body).dot(impulse);
    sum.values[4] = wide(bodies.velocity[body].load() - free_velocity(body)).dot(impulse);
    sum.values[5] = static_cast<double>(bodies.inverse_mass[body]) * impulse.dot(impulse);
    if (removal == 0 && slow_keep_loads && sum.values[5] > 0) {
      const Vector3<double> v = wide(bodies.velocity[body]);
      sum.values[7] = static_cast<double>(bodies.mass[body]) * v.dot(v);
    }
    if (removal == 0 && load_factor != nullptr)
      sum.values[6] = (2 * wide(bodies.velocity[body]) - wide(start[body])).dot(impulse);
    if (start_spin == nullptr || !has_moments(removal)) return sum;
    AngularState<Real> angular = angular_state(body);
    const Vector3<double> moment = wide(removed.moment);
    const Vector3<Real> before = free_angular_velocity(body);
    sum.values[3] += wide(work_angular_velocity(body)).dot(moment);
    sum.values[4] += wide(angular.velocity - before).dot(moment);
    angular.velocity = Vector3<Real>::Zero();
    angular.apply_angular_impulse(removed.moment);
    sum.values[5] += wide(angular.velocity).dot(moment);
    return sum;
  }
  /// Steps of steepest descent do not change angular velocities.
  SIM_HD static bool has_moments(int removal) { return removal == 0 || is_rigid(removal); }
  /// What the removal takes a share from.
  SIM_HD Change removed_of(int removal, int body) const {
    return removal == 0 ? change_of(body) : is_rigid(removal) ? relative_of(body) : opposing_of(body);
  }
  /// Momentum of a body relative to the rigid motion of its island, or to the ground that the island touches.
  SIM_HD Change relative_of(int body) const {
    Change relative{Vector3<Real>::Zero(), Vector3<Real>::Zero()};
    if (is_grounded(body)) {
      relative.impulse = bodies.mass[body] * bodies.velocity[body].load();
      if (start_spin != nullptr) relative.moment = angular_state(body).momentum();
      return relative;
    }
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    RigidSums all;
    for (std::uint32_t k = 0; k < RigidSums::count; ++k)
      all.values[k] =
          unit_of_sum(rigid_scale[at(root, RigidSums::kind_of(k), RigidSums::kinds)], rigid_bits()) *
          static_cast<double>(static_cast<std::int64_t>(rigid_sums[at(root, k, RigidSums::count)]));
    if (!(all.values[0] > 0)) return relative;
    const RigidMotion rigid = all.motion();
    const Vector3d velocity = wide(bodies.velocity[body]) - wide(moved[root]) -
                              rigid.velocity_at(wide(bodies.position[body]) - wide(bodies.position[root]));
    relative.impulse = bodies.mass[body] * Vector3<Real>(velocity.template cast<Real>());
    if (start_spin == nullptr) return relative;
    AngularState<Real> angular = angular_state(body);
    angular.velocity -= Vector3<Real>(rigid.spin.template cast<Real>());
    relative.moment = angular.momentum();
    return relative;
  }
};

}  // namespace collidoscope
