#include "sim_cuda/solver/energy_guard.h"

#include <algorithm>
#include <bit>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/disjoint_sets.h"
#include "sim_cuda/solver/friction.h"

namespace collidoscope {

namespace {

/// Energy terms of a body, J.
struct EnergyTerms {
  double square, linear, allowed;  ///< A, B, C
};

template <class Real>
struct GuardRounds {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const PackedVector3<Real>*start, *start_spin, *moved;
  Vector3<Real> gravity;       ///< m/s^2
  const Vector3<Real>* field;  ///< m/s^2, by body; null without attractors
  bool with_gravity;
  Real h;  ///< s
  GuardedContacts<Real> contacts;
  const WallPlane<Real>* planes;
  int plane_count, surfaces;
  JointView<Real> joints;
  StaticImpulse* static_impulses;
  const StepControl* control;
  std::uint32_t *flag, *parent, *scale;
  std::uint64_t* sums;
  std::uint8_t* exempt;
  const std::uint8_t* is_free;  ///< see EnergyGuard; null: the integrator is Euler's

  static constexpr int rounds = 9;
  SIM_HD std::int64_t items(int round) const {
    if (control->overflow) return 0;
    if (round == 0) return body_count;
    if (atomic_load(flag) == 0) return 0;
    if (round == 8) return 1;
    if (round == 2 || round == 7) return static_cast<std::int64_t>(control->contacts);
    return round == 3 ? joints.count : body_count;
  }
  SIM_HD void operator()(int round, int item) const {
    switch (round) {
      case 0: return test(item);
      case 1: return begin(item);
      case 2: return join_contact(static_cast<std::uint32_t>(item));
      case 3: return join_joint(item);
      case 4: return find_scale(item);
      case 5: return add(item);
      case 6: return scale_body(item);
      case 7: return scale_contact(item);
      default: *flag = 0;
    }
  }

 private:
  static constexpr int bits = 38;  ///< of a term; leaves 2^24 terms per sum

  SIM_HD bool is_guarded(std::uint32_t body) const {
    return bodies.inverse_mass[body] > 0 && (contacts.asleep == nullptr || contacts.asleep[body] == 0);
  }
  SIM_HD Vector3<Real> pull(int body) const {
    return field != nullptr ? Vector3<Real>(gravity + field[body]) : gravity;
  }
  /// Without the contacts of the substep.
  SIM_HD Vector3<Real> free_velocity(int body) const {
    if (is_free != nullptr && is_free[body] != 0) return moved[body];
    const Vector3<Real> v = start[body];
    return with_gravity ? Vector3<Real>(v + h * pull(body)) : v;
  }
  /// Without the impulses of the substep, in the current orientation.
  SIM_HD Vector3<Real> free_angular_velocity(int body) const {
    return AngularState<Real>::of(bodies, static_cast<std::uint32_t>(body)).velocity_of(start_spin[body].load());
  }
  SIM_HD static Vector3<double> wide(const Vector3<Real>& v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
  }
  SIM_HD EnergyTerms terms(int body) const {
    const Vector3<Real> change = bodies.velocity[body].load() - free_velocity(body);
    Vector3<Real> before = Vector3<Real>::Zero(), spin_change = before;
    if (start_spin != nullptr) {
      before = free_angular_velocity(body);
      spin_change = bodies.angular_velocity[body].load() - before;
    }
    EnergyTerms sum{0, 0, 0};
    if (change.dot(change) == 0 && spin_change.dot(spin_change) == 0) return sum;
    const double m = static_cast<double>(bodies.mass[body]);
    const Vector3<double> d = wide(change), w = wide(start[body]), g = wide(h * pull(body));
    sum = {m / 2 * d.dot(d), m * w.dot(d), with_gravity ? m / 2 * g.dot(g) : 0.0};
    if (start_spin != nullptr) {
      const Quaternion<Real> q = bodies.orientation[body];
      const Vector3<double> old = wide(q.conjugate() * before), added = wide(q.conjugate() * spin_change),
                            inertia = wide(bodies.inertia[body]);
      for (int k = 0; k < 3; ++k) {
        sum.square += inertia[k] / 2 * added[k] * added[k];
        sum.linear += inertia[k] * old[k] * added[k];
      }
    }
    return sum;
  }
  /// A gain below this is rounding, J.
  SIM_HD static double tolerance(const EnergyTerms& sum) {
    constexpr double relative = sizeof(Real) == 4 ? 1e-5 : 1e-9;
    return relative * (sum.square + (sum.linear < 0 ? -sum.linear : sum.linear)) + 1e-4 * sum.allowed;
  }
  SIM_HD static bool gains(const EnergyTerms& sum) {
    return sum.square + sum.linear - sum.allowed > tolerance(sum);
  }

  SIM_HD void test(int body) const {
    if (!is_guarded(static_cast<std::uint32_t>(body))) return;
    add_push_work(body, moved[body], bodies.velocity[body]);
    if (gains(terms(body))) atomic_store(flag, std::uint32_t{1});
  }
  /// For a velocity that changes after the move.
  SIM_HD void add_push_work(int body, const Vector3<Real>& before, const Vector3<Real>& after) const {
    if (!with_gravity) return;
    const Real work = -h * bodies.mass[body] * pull(body).dot(before - after);
    if (work != 0) static_impulses[body].push_work += static_cast<double>(work);
  }
  SIM_HD void begin(int body) const {
    parent[body] = static_cast<std::uint32_t>(body);
    scale[body] = 0;
    exempt[body] = 0;
    for (int k = 0; k < 3; ++k) sums[3 * body + k] = 0;
  }
  SIM_HD bool is_moving(std::uint32_t body) const {
    const Vector3<Real> v = bodies.velocity[body];
    if (v.dot(v) > 0) return true;
    if (bodies.angular_velocity == nullptr) return false;
    const Vector3<Real> w = bodies.angular_velocity[body];
    return w.dot(w) > 0;
  }
  SIM_HD void join(std::uint32_t a, std::uint32_t b) const {
    const bool guarded_a = is_guarded(a), guarded_b = is_guarded(b);
    if (guarded_a && guarded_b) return join_sets(parent, a, b);
    if (guarded_a && bodies.inverse_mass[b] == 0 && is_moving(b)) atomic_store(&exempt[a], std::uint8_t{1});
    if (guarded_b && bodies.inverse_mass[a] == 0 && is_moving(a)) atomic_store(&exempt[b], std::uint8_t{1});
  }
  SIM_HD void join_contact(std::uint32_t place) const {
    if (contacts.sums[place].total > 0 || contacts.sums[place].impact < 0)  // has pressed in this step
      join(contacts.ids[place].a, contacts.ids[place].b);
  }
  SIM_HD void join_joint(int joint) const {
    const JointRow<Real>& row = joints.rows[joint];
    if (row.b != JointRow<Real>::world) join(row.a, row.b);
    atomic_store(&exempt[row.a], std::uint8_t{1});
    if (row.b != JointRow<Real>::world) atomic_store(&exempt[row.b], std::uint8_t{1});
  }
  SIM_HD static float magnitude(const EnergyTerms& sum) {
    const double linear = sum.linear < 0 ? -sum.linear : sum.linear;
    return static_cast<float>(max_of(max_of(sum.square, linear), sum.allowed));
  }
  SIM_HD void find_scale(int body) const {
    if (!is_guarded(static_cast<std::uint32_t>(body))) return;
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    const float size = magnitude(terms(body));
    if (size > 0) atomic_max(&scale[root], std::bit_cast<std::uint32_t>(size));
    if (exempt[body] != 0) atomic_store(&exempt[root], std::uint8_t{1});
  }
  SIM_HD double unit(std::uint32_t root) const {
    return static_cast<double>(std::bit_cast<float>(scale[root])) / static_cast<double>(std::uint64_t{1} << bits);
  }
  SIM_HD void add(int body) const {
    if (!is_guarded(static_cast<std::uint32_t>(body))) return;
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    const EnergyTerms sum = terms(body);
    if (!(magnitude(sum) > 0)) return;
    const double one = unit(root);
    const double values[3] = {sum.square / one, sum.linear / one, sum.allowed / one};
    for (int k = 0; k < 3; ++k)
      atomic_add(&sums[3 * root + static_cast<std::uint32_t>(k)],
                 static_cast<std::uint64_t>(static_cast<std::int64_t>(values[k])));
  }
  /// Factor of the contact impulses of a body's island.
  SIM_HD Real factor(std::uint32_t body) const {
    if (!is_guarded(body)) return 1;
    const std::uint32_t root = root_of(parent, body);
    if (scale[root] == 0 || exempt[root] != 0) return 1;
    const double one = unit(root);
    const auto sum = [&](std::uint32_t k) { return one * static_cast<double>(static_cast<std::int64_t>(sums[3 * root + k])); };
    const EnergyTerms all{sum(0), sum(1), sum(2)};
    if (!gains(all) || !(all.square > 0)) return 1;
    using std::sqrt;
    const double root_term = sqrt(all.linear * all.linear + 4 * all.square * all.allowed);
    // The form without cancellation for each sign of B.
    const double f = all.linear > 0 ? 2 * all.allowed / (all.linear + root_term)
                                    : (root_term - all.linear) / (2 * all.square);
    return static_cast<Real>(clamp_to(f, 0.0, 1.0));
  }
  SIM_HD void scale_body(int body) const {
    const Real f = factor(static_cast<std::uint32_t>(body));
    if (f == 1) return;
    const Vector3<Real> free = free_velocity(body), v = bodies.velocity[body];
    const Vector3<Real> next = free + f * (v - free);
    bodies.velocity[body] = next;
    add_push_work(body, v, next);
    if (start_spin != nullptr) {
      const Vector3<Real> before = free_angular_velocity(body), w = bodies.angular_velocity[body];
      bodies.angular_velocity[body] = Vector3<Real>(before + f * (w - before));
    }
    for (int p = 0; p < surfaces; ++p) {
      const std::int64_t here = p * body_count + body;
      Real& impulse = contacts.plane_impulse[here];
      if (!(impulse > 0)) continue;
      const Vector3<Real> normal =
          p < plane_count ? planes[p].normal : contacts.box_planes[here - plane_count * body_count].normal;
      Vector3<Real> change = (f - 1) * impulse * normal;
      static_impulses[body].impulse += static_cast<double>((f - 1) * impulse);
      impulse *= f;
      if (contacts.plane_friction != nullptr) {
        change += (f - 1) * contacts.plane_friction[here];
        contacts.plane_friction[here] *= f;
      }
      for (int k = 0; k < 3; ++k) static_impulses[body].vector[k] += static_cast<double>(change[k]);
    }
  }
  SIM_HD void scale_contact(int place) const {
    const auto [a, b] = contacts.ids[place];
    PackedContact<Real>& contact = contacts.soft[place];
    if (!(contact.impulse > 0)) return;
    const Real f = is_guarded(a) ? factor(a) : factor(b);
    if (f == 1) return;
    contact.impulse *= f;
    contact.friction_impulse *= f;
  }
};

}  // namespace

template <class Real>
EnergyGuard<Real>::EnergyGuard(Executor& executor, const SolverScene<Real>& scene)
    : executor_(executor),
      scene_(scene),
      start_velocity_(executor, "velocities at substep start"),
      start_spin_(executor, "spins at substep start"),
      moved_velocity_(executor, "velocities of the move"),
      flag_(executor, "energy guard flag"),
      parent_(executor, "energy guard islands"),
      scale_(executor, "energy guard scales"),
      sums_(executor, "energy guard sums"),
      exempt_(executor, "energy guard exemptions"),
      is_free_(executor, "freely moving bodies") {
  const auto n = static_cast<std::size_t>(scene.body_count);
  start_velocity_.resize_discarding(n);
  if (scene.effects.rotation && (scene.effects.friction || scene.effects.joints)) start_spin_.resize_discarding(n);
  moved_velocity_.resize_discarding(n);
  flag_.upload({0});
  parent_.resize_discarding(n);
  scale_.resize_discarding(n);
  sums_.resize_discarding(3 * n);
  exempt_.resize_discarding(n);
  if (scene.integrator != Integrator::semi_implicit_euler) is_free_.resize_discarding(n);
}

template <class Real>
void EnergyGuard<Real>::apply(Real h, const GuardedContacts<Real>& contacts, std::int64_t contact_capacity) {
  executor_.run_rounds(
      "relax", GuardRounds<Real>::rounds, std::max(scene_.body_count, contact_capacity),
      GuardRounds<Real>{scene_.bodies, scene_.body_count, start_velocity_.data(),
                        start_spin(),
                        moved_velocity_.data(), scene_.gravity,
                        scene_.effects.attractor ? scene_.field : nullptr,
                        scene_.effects.gravity || scene_.effects.attractor, h, contacts, scene_.planes, scene_.plane_count,
                        scene_.surfaces(),
                        scene_.joints != nullptr ? scene_.joints->view() : JointView<Real>{},
                        scene_.static_impulses, scene_.control, flag_.data(), parent_.data(), scale_.data(),
                        sums_.data(), exempt_.data(), is_free()});
}

template class EnergyGuard<float>;
template class EnergyGuard<double>;

}  // namespace collidoscope
