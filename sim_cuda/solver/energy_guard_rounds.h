#pragma once
// The rounds of the energy guard (energy_guard.h), for Executor::run_rounds: the test of the whole scene, the
// islands, then up to `removals` corrections of the islands that gain energy. The first one has one more
// round, for the loads; the last one has three more, for the sums of rigid motions. A removal tests only the
// islands that the removal before has corrected.

#include <bit>
#include <cstdint>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/cpu_lanes.h"
#include "sim_cuda/core/disjoint_sets.h"
#include "sim_cuda/core/round_kernels.h"
#include "sim_cuda/solver/energy_guard_sums.h"

namespace collidoscope {

template <class Real>
struct GuardRounds : GuardSums<Real> {
  using Sums = GuardSums<Real>;
  using Sums::active, Sums::add_push_work, Sums::add_energies, Sums::add_rigid, Sums::angular_state, Sums::at,
      Sums::bodies, Sums::body_count, Sums::changes, Sums::contacts, Sums::control, Sums::exempt,
      Sums::find_rigid_scale, Sums::find_scale, Sums::for_each_body, Sums::free_angular_velocity,
      Sums::free_velocity, Sums::gain, Sums::gather_energies, Sums::gather_rigid, Sums::give_to_ground,
      Sums::grounded, Sums::group, Sums::has_left_plane, Sums::has_moments, Sums::has_pressed,
      Sums::is_active, Sums::is_exempt, Sums::is_first_substep, Sums::is_grounded, Sums::is_guarded,
      Sums::is_moving, Sums::is_rigid, Sums::joints, Sums::load_factor, Sums::parent, Sums::removals,
      Sums::rigid_scale, Sums::rigid_sums, Sums::scale, Sums::slow_keep_loads, Sums::start_spin, Sums::sums,
      Sums::surfaces, Sums::take_from_planes, Sums::touches_plane;
  using typename Sums::Change;
  double* gains;           ///< by body, J: energy added by contacts, less its rounding
  std::uint32_t* largest;  ///< bits of the largest magnitude in `gains` (float)
  std::uint64_t* total;    ///< `total_slots` partial sums of `gains`
  std::uint32_t* flags;    ///< 0: the scene gains energy; k > 0: an island does after the k-th removal

  static constexpr int test_rounds = 3, first_rounds = 6, rounds_per_removal = 5;
  static constexpr int rigid_rounds = 3;
  static constexpr int rounds = first_rounds + removals * rounds_per_removal + 1 + rigid_rounds;

  SIM_HD std::int64_t items(int round) const {
    const auto contact_count = static_cast<std::int64_t>(control->contacts);
    if (control->overflow) return -1;
    if (round >= test_rounds && atomic_load(flags + removal_of(round)) == 0) return -1;
    if (is_by_group(round)) return (body_count + group - 1) / group;
    if (round == 2) return 1;
    if (round == 4) return contact_count;
    if (round == 5) return joints.count;
    if (round < first_rounds || !has_contacts(round)) return body_count;
    if (part_of(round) == Part::loads && load_factor == nullptr) return 0;
    return max_of(body_count, contact_count);
  }
  /// A round on the CPU; see MarkedRounds.
  struct Round {
    GuardRounds rounds;
    int number;
    void operator()(int item) const { rounds(number, item); }
    ItemMarks marks() const {
      const int removal = removal_of(number);
      if (number < first_rounds || is_by_group(number)) return {};
      if (has_contacts(number)) return {};
      return {rounds.active, static_cast<std::uint8_t>(removal + 1)};
    }
    std::int64_t items_per_chunk() const { return is_by_group(number) ? 1 : usual_chunk; }
  };
  Round round(int number) const { return {*this, number}; }
  SIM_HD void operator()(int round, int item) const {
    switch (round) {
      case 0:
        return find_gain(item);
      case 1:
        return add_gain(item);
      case 2:
        return test();
      case 3:
        return begin(item);
      case 4:
        return join_contact(static_cast<std::uint32_t>(item));
      case 5:
        return join_joint(item);
    }
    const int removal = removal_of(round);
    switch (part_of(round)) {
      case Part::clear:
        return prepare(removal, item);
      case Part::scale_rigid:
        return find_rigid_scale(item);
      case Part::add_rigid:
        return add_rigid(removal, item);
      case Part::gather_rigid:
        return gather_rigid(removal, item);
      case Part::scale:
        return find_scale(removal, item);
      case Part::add:
        return add_energies(removal, item);
      case Part::gather:
        return gather_energies(removal, item);
      case Part::remove:
        return remove(removal, item);
      case Part::loads:
        return scale_loads(item);
    }
  }

 private:
  static constexpr int total_slots = EnergyGuard<Real>::total_slots;
  /// Sums of fewer units are not resolved.
  static constexpr double resolution = 4096;
  /// Largest share of opposing impulses: twice what stops a single pair.
  static constexpr double largest_descent = 2;
  /// At least this share of a load remains: the next iteration must replace what is missing.
  /// With 1, a tall pile that is stopped rises by ten times as much. 0.95 has a quarter of the effect.
  static constexpr double least_load_factor = 0.65;
  /// With friction, the loads of slower islands are reduced less: sum of m v . v over that of P . P / m,
  /// which is the sum of m (g h)^2 at rest. One factor for all loads takes from a whole pile at rest what
  /// single bodies gain. With the full factor, 100 layers come to rest after 18 instead of 10 s, and 200,000
  /// spheres do not.
  static constexpr double full_motion = 2;
  static constexpr double relative_rounding = sizeof(Real) == 4 ? 1e-6 : 1e-9;

  /// `loads`: only after the first removal.
  enum class Part { clear, scale_rigid, add_rigid, gather_rigid, scale, add, gather, remove, loads };

  SIM_HD static int removal_of(int round) {
    const int later = round - first_rounds - 1;
    return later < rounds_per_removal ? 0 : min_of(later / rounds_per_removal, removals - 1);
  }
  SIM_HD static Part part_of(int round) {
    const int removal = removal_of(round);
    const int part = round - first_rounds - removal * rounds_per_removal - (removal > 0 ? 1 : 0);
    return static_cast<Part>(part == 0 || is_rigid(removal) ? part : part + rigid_rounds);
  }
  /// True if the items of the round are bodies and contacts.
  SIM_HD static bool has_contacts(int round) {
    const Part part = part_of(round);
    return part == Part::loads || (part == Part::clear && removal_of(round) > 0);
  }
  /// True if an item of the round is a group of bodies. On the CPU, this includes the rounds that add terms
  /// of bodies: atomics of several threads at one sum take much longer than the terms.
  SIM_HD static bool is_by_group(int round) {
#if defined(__CUDA_ARCH__)
    constexpr bool adds_groups = false;
#else
    constexpr bool adds_groups = true;
#endif
    if (round < first_rounds) return adds_groups && round == 1;
    const Part part = part_of(round);
    return part == Part::gather || part == Part::gather_rigid ||
           (adds_groups && (part == Part::add || part == Part::add_rigid));
  }

  // ---- rounds ----

  SIM_HD void find_gain(int body) const {
    if (is_first_substep) parent[body] = static_cast<std::uint32_t>(body);
    double& gained = gains[body];
    gained = 0;
    if (!is_guarded(static_cast<std::uint32_t>(body))) return;
    add_push_work(body);
    const EnergyTerms sum = gain(body);
    gained = sum.gain() - sum.rounding(relative_rounding);
    const float size = static_cast<float>(gained < 0 ? -gained : gained);
    if (!is_finite(size) || size == 0) {
      gained = 0;
      return;
    }
    atomic_max(largest, std::bit_cast<std::uint32_t>(size));
  }
  /// `item`: a body, or a group on the CPU.
  SIM_HD void add_gain(int item) const {
#if defined(__CUDA_ARCH__)
    if (gains[item] == 0) return;
    constexpr int bodies_per_slot = 32;  // those of a warp
    atomic_add_aggregated<1>(&total[item / bodies_per_slot % total_slots],
                             {in_units(gains[item], unit_of_sum(*largest))});
#else
    const double one = unit_of_sum(*largest);
    std::uint64_t sum = 0;
    for_each_body(item, [&](int body) {
      if (gains[body] != 0) sum += in_units(gains[body], one);
    });
    if (sum != 0) atomic_add(&total[item % total_slots], sum);
#endif
  }
  SIM_HD void test() const {
    std::uint64_t sum = 0;
    for (int slot = 0; slot < total_slots; ++slot) {
      sum += total[slot];
      total[slot] = 0;
    }
    *largest = 0;
    flags[0] = static_cast<std::int64_t>(sum) > 0 ? 1 : 0;
    for (int removal = 1; removal < removals; ++removal) flags[removal] = 0;
  }
  SIM_HD void begin(int body) const {
    grounded[body] = touches_plane(body) || has_left_plane(body) ? 1 : 0;
    exempt[body] = is_exempt(body) ? 1 : 0;
    if (load_factor != nullptr) load_factor[body] = 1;
    const bool may_gain = grounded[body] != 0 || gains[body] != 0;
    active[body] = may_gain && is_guarded(static_cast<std::uint32_t>(body)) ? 1 : 0;
  }
  SIM_HD void join(std::uint32_t a, std::uint32_t b) const {
    const bool guarded_a = is_guarded(a), guarded_b = is_guarded(b);
    if (guarded_a) atomic_store(&active[a], std::uint8_t{1});
    if (guarded_b) atomic_store(&active[b], std::uint8_t{1});
    if (guarded_a && guarded_b) return join_sets(parent, a, b);
    if (guarded_a && bodies.inverse_mass[b] == 0) join_static(a, b);
    if (guarded_b && bodies.inverse_mass[a] == 0) join_static(b, a);
  }
  SIM_HD void join_static(std::uint32_t body, std::uint32_t fixed) const {
    atomic_store(&(is_moving(fixed) ? exempt : grounded)[body], std::uint8_t{1});
  }
  SIM_HD void join_contact(std::uint32_t place) const {
    if (has_pressed(place)) join(contacts.ids[place].a, contacts.ids[place].b);
  }
  SIM_HD void join_joint(int joint) const {
    const JointRow<Real>& row = joints.rows[joint];
    if (row.b != JointRow<Real>::world)
      join(row.a, row.b);
    else if (is_guarded(row.a)) {
      atomic_store(&grounded[row.a], std::uint8_t{1});
      atomic_store(&active[row.a], std::uint8_t{1});
    }
  }
  /// Clears the sums. Before the first removal, marks the roots of islands. Before a step of steepest
  /// descent, computes the opposing impulses of contacts.
  SIM_HD void prepare(int removal, int item) const {
    const bool is_body = item < body_count && is_active(removal, static_cast<std::uint32_t>(item));
    if (removal == 0 && is_body) mark_island(item);
    const bool has_sums = is_body && (is_root(item) || item % group == 0);
    if (has_sums) {
      scale[item] = 0;
      for (std::uint32_t k = 0; k < EnergyTerms::count; ++k)
        sums[EnergyTerms::count * static_cast<std::uint32_t>(item) + k] = 0;
    }
    if (is_rigid(removal) && has_sums) {
      for (std::uint32_t k = 0; k < RigidSums::kinds; ++k) rigid_scale[at(item, k, RigidSums::kinds)] = 0;
      for (std::uint32_t k = 0; k < RigidSums::count; ++k) rigid_sums[at(item, k, RigidSums::count)] = 0;
    }
    if (removal == 0 || is_rigid(removal) || item >= static_cast<std::int64_t>(control->contacts)) return;
    const auto place = static_cast<std::uint32_t>(item);
    const Pair ids = contacts.ids[place];
    if (!is_active(removal, ids.a) && !is_active(removal, ids.b)) return;
    const Real mass = 1 / (bodies.inverse_mass[ids.a] + bodies.inverse_mass[ids.b]);
    const Vector3<Real> velocity = bodies.velocity[ids.b].load() - bodies.velocity[ids.a].load();
    contacts.opposing[place] =
        has_pressed(place) ? mass * velocity.dot(contacts.soft[place].normal) : Real(0);
  }
  SIM_HD bool is_root(int body) const {
    return atomic_load(&parent[body]) == static_cast<std::uint32_t>(body);
  }
  SIM_HD void mark_island(int body) const {
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    if (atomic_load(&exempt[body]) != 0) atomic_store(&exempt[root], std::uint8_t{1});
    if (atomic_load(&grounded[body]) != 0) atomic_store(&grounded[root], std::uint8_t{1});
  }
  SIM_HD void remove(int removal, int body) const {
    const EnergyCorrection correction = correction_of(removal, static_cast<std::uint32_t>(body));
    if (correction.is_none()) return;
    const Real share = static_cast<Real>(correction.share), factor = static_cast<Real>(correction.factor);
    const Vector3<Real> v = bodies.velocity[body];
    Vector3<Real> next;
    if (factor < 1) {
      next = free_velocity(body) + factor * (v - free_velocity(body));
      give_to_ground(body, Vector3<Real>(next - v));
      take_from_planes(body, 1 - factor, false);
    } else {
      const Change removed = changes[body];
      if (removal == 0) take_from_planes(body, share, true);
      next = v - share * bodies.inverse_mass[body] * removed.impulse;
      if (is_rigid(removal) && is_grounded(body)) give_to_ground(body, Vector3<Real>(next - v));
      if (start_spin != nullptr && has_moments(removal)) {
        AngularState<Real> angular = angular_state(body);
        angular.apply_angular_impulse(-share * removed.moment);
        bodies.angular_velocity[body] = angular.velocity;
      }
    }
    bodies.velocity[body] = next;
    add_push_work(body, v, next);
    if (start_spin == nullptr || !(factor < 1)) return;
    const Vector3<Real> before = free_angular_velocity(body), w = bodies.angular_velocity[body];
    bodies.angular_velocity[body] = Vector3<Real>(before + factor * (w - before));
  }

  /// Scales the impulses for warm starting. `item`: a body with its planes, and a contact.
  SIM_HD void scale_loads(int item) const {
    if (item < body_count && is_guarded(static_cast<std::uint32_t>(item))) {
      const Real factor = static_cast<Real>(load_factor_of(static_cast<std::uint32_t>(item)));
      for (int p = 0; factor < 1 && p < surfaces; ++p)
        contacts.plane_impulse[p * body_count + item] *= factor;
    }
    if (item >= static_cast<std::int64_t>(control->contacts)) return;
    const auto [a, b] = contacts.ids[item];
    const float factor = load_factor_of(is_guarded(a) ? a : b);
    if (factor < 1) contacts.soft[item].impulse *= static_cast<Real>(factor);
  }
  SIM_HD float load_factor_of(std::uint32_t body) const { return load_factor[root_of(parent, body)]; }
  /// Factor of the loads of an island. `removed`: share of impulses that has been removed from velocities.
  SIM_HD double factor_of(const EnergyTerms& all, double removed) const {
    const double part = slow_keep_loads ? min_of(all.motion() / (full_motion * all.by_self()), 1.0) : 1.0;
    return min_of(max_of(1 + part * (all.next_loads(removed) - 1), least_load_factor), 1.0);
  }

  /// Correction of the island of a body. Requests the next removal if energy is still gained after it.
  SIM_HD EnergyCorrection correction_of(int removal, std::uint32_t body) const {
    if (!is_active(removal, body)) return {};
    active[body] = 0;
    const std::uint32_t root = root_of(parent, body);
    if (scale[root] == 0 || exempt[root] != 0) return {};
    EnergyTerms all;
    for (std::uint32_t k = 0; k < EnergyTerms::count; ++k)
      all.values[k] = unit_of_sum(scale[root]) *
                      static_cast<double>(static_cast<std::int64_t>(sums[EnergyTerms::count * root + k]));
    const double error = all.rounding(relative_rounding) +
                         relative_rounding * static_cast<double>(std::bit_cast<float>(scale[root]));
    if (!(all.gain() > (removal == 0 ? 0 : error))) return {};
    EnergyCorrection correction;
    int next = removal + 1;  // tests the island again: the correction is exact only if nothing turns
    bool more;
    if (removal == 1 && grounded[root] != 0) {
      correction = all.scaled();
      more = all.gain_with(correction.factor) > error;
      next = removals - 1;
    } else {
      if (all.linear() > resolution * unit_of_sum(scale[root]))
        correction = all.without_share(has_moments(removal) ? 1.0 : largest_descent);
      more = all.gain_without(correction.share) > error;
      if (removal == 0 && load_factor != nullptr && body == root &&
          all.by_self() > resolution * unit_of_sum(scale[root]))
        load_factor[body] = static_cast<float>(factor_of(all, correction.share));
    }
    if (next >= removals) return correction;
    active[body] = static_cast<std::uint8_t>(next + 1);
    if (more)
      for (int k = removal + 1; k <= next; ++k) atomic_store(flags + k, std::uint32_t{1});
    return correction;
  }
};

}  // namespace collidoscope
