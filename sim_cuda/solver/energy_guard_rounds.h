#pragma once
// More than 400 lines: the rounds of one launch, which share their data.
//
// The rounds of the energy guard (energy_guard.h), for Executor::run_rounds: the test of the whole scene, the
// islands, then up to `removals` corrections of the islands that gain energy. The last one has two more
// rounds, for the sums of rigid motions. A removal tests only the islands that the removal before has
// corrected.

#include <bit>
#include <cstdint>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/cpu_lanes.h"
#include "sim_cuda/core/disjoint_sets.h"
#include "sim_cuda/core/round_kernels.h"
#include "sim_cuda/solver/energy_guard_bodies.h"
#include "sim_cuda/solver/rigid_motion.h"

namespace collidoscope {

template <class Real>
struct GuardRounds : GuardedBodies<Real> {
  using Bodies = GuardedBodies<Real>;
  using Bodies::add_push_work, Bodies::angular_state, Bodies::bodies, Bodies::body_count, Bodies::change_of,
      Bodies::contacts, Bodies::control, Bodies::free_angular_velocity, Bodies::free_velocity, Bodies::gain,
      Bodies::give_to_ground, Bodies::has_left_plane, Bodies::has_pressed, Bodies::is_exempt,
      Bodies::is_first_substep, Bodies::is_guarded, Bodies::is_moving, Bodies::joints, Bodies::moved,
      Bodies::opposing_of, Bodies::planes, Bodies::start_spin, Bodies::take_from_planes,
      Bodies::touches_plane, Bodies::wide, Bodies::work_angular_velocity, Bodies::work_velocity;
  using typename Bodies::Change;
  double* gains;           ///< by body, J: energy added by contacts, less its rounding
  std::uint32_t* largest;  ///< bits of the largest magnitude in `gains` (float)
  std::uint64_t* total;    ///< `total_slots` partial sums of `gains`
  std::uint32_t* flags;    ///< 0: the scene gains energy; k > 0: an island does after the k-th removal
  std::uint32_t *parent, *scale;
  EnergyTerms* terms_of;            ///< by body
  ContactChange<Real>* changes;     ///< by body: what a removal takes a share from
  std::uint64_t* sums;              ///< by root: see EnergyTerms; partial sums by first body of a group
  std::uint8_t *exempt, *grounded;  ///< by body, then by root
  std::uint8_t* active;             ///< by body: 1 + the next removal of its island, or 0
  std::uint32_t* rigid_scale;       ///< by root and kind: bits of the largest value (float)
  std::uint64_t* rigid_sums;        ///< by root: RigidSums, in units of the largest value of a kind

  /// Removals: impulses at the end of the substep, steps of steepest descent, motion relative to the rigid
  /// motion.
  static constexpr int removals = EnergyGuard<Real>::removals;
  static constexpr int test_rounds = 3, first_rounds = 6, rounds_per_removal = 5;
  static constexpr int rigid_rounds = 3;
  static constexpr int rounds = first_rounds + removals * rounds_per_removal + rigid_rounds;

  SIM_HD std::int64_t items(int round) const {
    const auto contact_count = static_cast<std::int64_t>(control->contacts);
    if (control->overflow) return -1;
    if (round >= test_rounds && atomic_load(flags + removal_of(round)) == 0) return -1;
    if (is_by_group(round)) return (body_count + group - 1) / group;
    if (round == 2) return 1;
    if (round == 4) return contact_count;
    if (round == 5) return joints.count;
    const bool clears_contacts =
        round >= first_rounds && part_of(round) == Part::clear && removal_of(round) > 0;
    return clears_contacts ? max_of(body_count, contact_count) : body_count;
  }
  /// A round on the CPU; see MarkedRounds.
  struct Round {
    GuardRounds rounds;
    int number;
    void operator()(int item) const { rounds(number, item); }
    ItemMarks marks() const {
      const int removal = removal_of(number);
      if (number < first_rounds || is_by_group(number)) return {};
      if (part_of(number) == Part::clear && removal > 0) return {};
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
        return add_terms<RigidSums::count>(removal, rigid_sums, item, RigidUnits{*this});
      case Part::gather_rigid:
        return gather<RigidSums::count>(removal, rigid_sums, item);
      case Part::scale:
        return find_scale(removal, item);
      case Part::add:
        return add_terms<EnergyTerms::count>(removal, sums, item, EnergyUnits{*this});
      case Part::gather:
        return gather<EnergyTerms::count>(removal, sums, item);
      case Part::remove:
        return remove(removal, item);
    }
  }

 private:
  static constexpr int total_slots = EnergyGuard<Real>::total_slots;
  /// Bodies whose terms are added together before they are added to the sum of the island.
  static constexpr int group = 1024;
  /// Sums of fewer units are not resolved.
  static constexpr double resolution = 4096;
  /// Largest share of opposing impulses: twice what stops a single pair.
  static constexpr double largest_descent = 2;
  static constexpr double relative_rounding = sizeof(Real) == 4 ? 1e-6 : 1e-9;

  enum class Part { clear, scale_rigid, add_rigid, gather_rigid, scale, add, gather, remove };

  SIM_HD static int removal_of(int round) {
    return round < first_rounds ? 0 : min_of((round - first_rounds) / rounds_per_removal, removals - 1);
  }
  SIM_HD static Part part_of(int round) {
    const int removal = removal_of(round), part = round - first_rounds - removal * rounds_per_removal;
    return static_cast<Part>(part == 0 || is_rigid(removal) ? part : part + rigid_rounds);
  }
  SIM_HD static bool is_rigid(int removal) { return removal == removals - 1; }
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
  /// Calls `act` for the bodies of a group.
  template <class Act>
  SIM_HD void for_each_body(int number, const Act& act) const {
    const int first = number * group;
    for (int body = first; body < body_count && body < first + group; ++body) act(body);
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
    const bool may_gain = grounded[body] != 0 || gains[body] != 0;
    active[body] = may_gain && is_guarded(static_cast<std::uint32_t>(body)) ? 1 : 0;
  }
  SIM_HD bool is_active(int removal, std::uint32_t body) const {
    return atomic_load(&active[body]) == removal + 1;
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
    const GuardRounds& rounds;
    SIM_HD bool operator()(int body, std::uint32_t root, std::uint64_t (&units)[RigidSums::count]) const {
      const RigidSums terms = rounds.rigid_terms(body, root);
      const int bits = rounds.rigid_bits();
      for (std::uint32_t k = 0; k < RigidSums::count; ++k) {
        const std::uint32_t scale_bits =
            rounds.rigid_scale[at(root, RigidSums::kind_of(k), RigidSums::kinds)];
        if (scale_bits != 0) units[k] = in_units(terms.values[k], unit_of_sum(scale_bits, bits), bits);
      }
      return true;
    }
  };
  struct EnergyUnits {
    const GuardRounds& rounds;
    SIM_HD bool operator()(int body, std::uint32_t root, std::uint64_t (&units)[EnergyTerms::count]) const {
      if (rounds.scale[root] == 0) return false;
      const EnergyTerms terms = rounds.terms_of[body];
      const double one = unit_of_sum(rounds.scale[root]);
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

  /// True if the body's island touches planes or static bodies.
  SIM_HD bool is_grounded(int body) const {
    return grounded[root_of(parent, static_cast<std::uint32_t>(body))] != 0;
  }

  // ---- sums ----

  SIM_HD EnergyTerms terms(int removal, int body) const {
    EnergyTerms sum = gain(body);
    const Change removed = changes[body] = removed_of(removal, body);
    const Vector3<double> impulse = wide(removed.impulse);
    sum.values[3] = work_velocity(body).dot(impulse);
    sum.values[4] = wide(bodies.velocity[body].load() - free_velocity(body)).dot(impulse);
    sum.values[5] = static_cast<double>(bodies.inverse_mass[body]) * impulse.dot(impulse);
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
    }
    if (next >= removals) return correction;
    active[body] = static_cast<std::uint8_t>(next + 1);
    if (more)
      for (int k = removal + 1; k <= next; ++k) atomic_store(flags + k, std::uint32_t{1});
    return correction;
  }
};

}  // namespace collidoscope
