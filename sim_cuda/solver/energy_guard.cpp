#include "sim_cuda/solver/energy_guard.h"

#include <algorithm>
#include <bit>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/disjoint_sets.h"
#include "sim_cuda/solver/friction.h"

namespace collidoscope {

namespace {

template <class Real>
struct GuardRounds {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const PackedVector3<Real>*start, *start_spin, *moved;
  const std::uint8_t* is_free;  ///< see EnergyGuard; null: the integrator is Euler's
  Vector3<Real> gravity;        ///< m/s^2
  const Vector3<Real>* field;   ///< m/s^2, by body; null without attractors
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

  static constexpr int rounds = 8;
  SIM_HD std::int64_t items(int round) const {
    if (control->overflow) return 0;
    if (round == 0) return body_count;
    if (atomic_load(flag) == 0) return 0;
    return round == 2 ? static_cast<std::int64_t>(control->contacts)
           : round == 3 ? joints.count
           : round == 7 ? 1
                        : body_count;
  }
  SIM_HD void operator()(int round, int item) const {
    switch (round) {
      case 0: return test(item);
      case 1: return begin(item);
      case 2: return join_contact(static_cast<std::uint32_t>(item));
      case 3: return join_joint(item);
      case 4: return find_scale(item);
      case 5: return add(item);
      case 6: return remove(item);
      default: *flag = 0;
    }
  }

 private:
  /// Bits of a term in a sum; leaves room for 2^24 terms.
  static constexpr int bits = 38;

  /// Energy terms of a body, J: G, S and D of the header.
  struct Terms {
    double gain, linear, square;
    SIM_HD float magnitude() const {
      const double largest = max_of(gain < 0 ? -gain : gain, max_of(linear < 0 ? -linear : linear, square));
      return static_cast<float>(largest);
    }
  };
  /// Velocity changes by the contacts of a body, as they act at the current positions.
  struct Change {
    Vector3<Real> impulse, moment;  ///< N s, N m s
  };

  // ---- bodies ----

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
    const Vector3<Real> v = start[body];
    return with_gravity ? Vector3<Real>(v + h * pull(body)) : v;
  }
  /// The same of the angular velocity, in the current orientation.
  SIM_HD Vector3<Real> free_angular_velocity(int body) const {
    return angular_state(body).velocity_of(start_spin[body].load());
  }
  SIM_HD AngularState<Real> angular_state(int body) const {
    return AngularState<Real>::of(bodies, static_cast<std::uint32_t>(body));
  }
  SIM_HD static Vector3<double> wide(const Vector3<Real>& v) {
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
  }
  /// Energy that contacts have added to a body. `rounding`: error of it, J.
  SIM_HD double gain(int body, double& rounding) const {
    rounding = 0;
    const Vector3<Real> change = bodies.velocity[body].load() - free_velocity(body);
    Vector3<Real> before = Vector3<Real>::Zero(), spin_change = before;
    if (start_spin != nullptr) {
      before = free_angular_velocity(body);
      spin_change = bodies.angular_velocity[body].load() - before;
    }
    if (change.dot(change) == 0 && spin_change.dot(spin_change) == 0) return 0;
    const double m = static_cast<double>(bodies.mass[body]);
    const Vector3<double> d = wide(change), w = wide(start[body]);
    double linear = m * w.dot(d), square = m / 2 * d.dot(d), allowed = 0;
    if (with_gravity && !moved_freely(body)) {
      const Vector3<double> g = wide(h * pull(body));
      allowed = m / 2 * g.dot(g);
    }
    if (start_spin != nullptr) {
      const Quaternion<Real> q = bodies.orientation[body];
      const Vector3<double> old = wide(q.conjugate() * before), added = wide(q.conjugate() * spin_change),
                            inertia = wide(bodies.inertia[body]);
      for (int k = 0; k < 3; ++k) {
        linear += inertia[k] * old[k] * added[k];
        square += inertia[k] / 2 * added[k] * added[k];
      }
    }
    constexpr double relative = sizeof(Real) == 4 ? 1e-5 : 1e-9;
    rounding = relative * (square + (linear < 0 ? -linear : linear)) + 1e-4 * allowed;
    return square + linear - allowed;
  }

  // ---- rounds ----

  SIM_HD void test(int body) const {
    if (!is_guarded(static_cast<std::uint32_t>(body))) return;
    add_push_work(body, moved[body], bodies.velocity[body]);
    double rounding;
    if (gain(body, rounding) > rounding) atomic_store(flag, std::uint32_t{1});
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
    const ContactSums<Real> sum = contacts.sums[place];
    if (sum.total > 0 || sum.impact < 0) join(contacts.ids[place].a, contacts.ids[place].b);  // has pressed
  }
  SIM_HD void join_joint(int joint) const {
    const JointRow<Real>& row = joints.rows[joint];
    atomic_store(&exempt[row.a], std::uint8_t{1});
    if (row.b == JointRow<Real>::world) return;
    atomic_store(&exempt[row.b], std::uint8_t{1});
    join(row.a, row.b);
  }
  SIM_HD void find_scale(int body) const {
    if (!is_guarded(static_cast<std::uint32_t>(body))) return;
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    const float size = terms(body).magnitude();
    if (size > 0) atomic_max(&scale[root], std::bit_cast<std::uint32_t>(size));
    if (exempt[body] != 0) atomic_store(&exempt[root], std::uint8_t{1});
  }
  SIM_HD void add(int body) const {
    if (!is_guarded(static_cast<std::uint32_t>(body))) return;
    const std::uint32_t root = root_of(parent, static_cast<std::uint32_t>(body));
    if (scale[root] == 0) return;
    const Terms sum = terms(body);
    const double values[3] = {sum.gain, sum.linear, sum.square}, one = unit(root);
    for (std::uint32_t k = 0; k < 3; ++k)
      atomic_add(&sums[3 * root + k],
                 static_cast<std::uint64_t>(static_cast<std::int64_t>(values[k] / one)));
  }
  SIM_HD void remove(int body) const {
    const Real share = share_to_remove(static_cast<std::uint32_t>(body));
    if (!(share > 0)) return;
    const Change by_contacts = change_of(body, share);
    const Vector3<Real> v = bodies.velocity[body];
    const Vector3<Real> next = v - share * bodies.inverse_mass[body] * by_contacts.impulse;
    bodies.velocity[body] = next;
    add_push_work(body, v, next);
    if (start_spin == nullptr) return;
    AngularState<Real> angular = angular_state(body);
    angular.apply_angular_impulse(-share * by_contacts.moment);
    bodies.angular_velocity[body] = angular.velocity;
  }

  // ---- islands ----

  SIM_HD double unit(std::uint32_t root) const {
    return static_cast<double>(std::bit_cast<float>(scale[root])) /
           static_cast<double>(std::uint64_t{1} << bits);
  }
  SIM_HD Terms terms(int body) const {
    double rounding;
    Terms sum{gain(body, rounding), 0, 0};
    const Change by_contacts = change_of(body, 0);
    Vector3<Real> now = bodies.velocity[body];
    if (with_gravity) now -= h * pull(body);
    const Vector3<double> impulse = wide(by_contacts.impulse);
    sum.linear = wide(now).dot(impulse);
    sum.square = static_cast<double>(bodies.inverse_mass[body]) * impulse.dot(impulse);
    if (start_spin != nullptr) {
      AngularState<Real> angular = angular_state(body);
      const Vector3<double> moment = wide(by_contacts.moment);
      sum.linear += wide(angular.velocity).dot(moment);
      angular.velocity = Vector3<Real>::Zero();
      angular.apply_angular_impulse(by_contacts.moment);
      sum.square += wide(angular.velocity).dot(moment);
    }
    return sum;
  }
  /// Sums the impulses at the end of the substep. `removed` > 0: also takes this share of them from the sums
  /// of static bodies.
  SIM_HD Change change_of(int body, Real removed) const {
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
      const Vector3<Real> normal =
          p < plane_count ? planes[p].normal : contacts.box_planes[here - plane_count * body_count].normal;
      Vector3<Real> by_plane = impulse * normal;
      if (contacts.plane_friction != nullptr) {
        const Vector3<Real> friction = contacts.plane_friction[here];
        by_plane += friction;
        sum.moment -= radius * normal.cross(friction);
      }
      sum.impulse += by_plane;
      if (!(removed > 0)) continue;
      static_impulses[body].impulse -= static_cast<double>(removed * impulse);
      for (int k = 0; k < 3; ++k)
        static_impulses[body].vector[k] -= static_cast<double>(removed * by_plane[k]);
    }
    return sum;
  }
  /// Share of the contact impulses that the island of a body loses.
  SIM_HD Real share_to_remove(std::uint32_t body) const {
    if (!is_guarded(body)) return 0;
    const std::uint32_t root = root_of(parent, body);
    if (scale[root] == 0 || exempt[root] != 0) return 0;
    const auto sum = [&](std::uint32_t k) {
      return unit(root) * static_cast<double>(static_cast<std::int64_t>(sums[3 * root + k]));
    };
    const Terms all{sum(0), sum(1), sum(2)};
    if (!(all.gain > 0) || !(all.linear > 0)) return 0;
    const double discriminant = all.linear * all.linear - 2 * all.square * all.gain;
    using std::sqrt;
    const double share = discriminant > 0 ? 2 * all.gain / (all.linear + sqrt(discriminant))
                                          : all.linear / all.square;
    return static_cast<Real>(min_of(share, 1.0));
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
  if (scene.effects.rotation && (scene.effects.friction || scene.effects.joints))
    start_spin_.resize_discarding(n);
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
      GuardRounds<Real>{scene_.bodies, scene_.body_count, start_velocity_.data(), start_spin(),
                        moved_velocity_.data(), is_free(), scene_.gravity,
                        scene_.effects.attractor ? scene_.field : nullptr,
                        scene_.effects.gravity || scene_.effects.attractor, h, contacts, scene_.planes,
                        scene_.plane_count, scene_.surfaces(),
                        scene_.joints != nullptr ? scene_.joints->view() : JointView<Real>{},
                        scene_.static_impulses, scene_.control, flag_.data(), parent_.data(), scale_.data(),
                        sums_.data(), exempt_.data()});
}

template class EnergyGuard<float>;
template class EnergyGuard<double>;

}  // namespace collidoscope
