#include "sim_cuda/solver/joint_loops.h"

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/executor.h"
#include "sim_cuda/solver/tree_joint.h"

namespace collidoscope {
namespace {

/// Clears the sums of the substep and finds the groups that touch something.
template <class Real>
struct BeginLoops {
  LoopView<Real> loops;
  BodyView<Real> bodies;
  ImpulsesByBody<Real> impulses;
  const StepControl* control;
  static constexpr int rounds = 2;
  SIM_HD std::int64_t items(int round) const {
    if (control->overflow) return 0;
    return round == 0 ? loops.group_count : loops.body_count;
  }
  SIM_HD void operator()(int round, int item) const {
    if (round == 0) {
      loops.touches[item] = 0;
      return;
    }
    const std::uint32_t body = loops.bodies[item];
    const Vector3<Real> zero = Vector3<Real>::Zero();
    loops.correction[body] = loops.spin_correction[body] = zero;
    if (impulses.touches(static_cast<int>(body), *control))
      atomic_store(&loops.touches[loops.group_of[body]], 1u);
    if (loops.start_spin == nullptr) return;
    const Vector3<Real> spin = bodies.angular_velocity[body];
    loops.start_spin[body] = spin;
    loops.start_energy[body] = rotation_energy(bodies, body);
  }
  SIM_HD static double rotation_energy(const BodyView<Real>& bodies, std::uint32_t body) {
    const Vector3d w = widened<Real>(bodies.orientation[body]).conjugate() *
                       widened<Real>(Vector3<Real>(bodies.angular_velocity[body]));
    return w.dot(widened<Real>(bodies.inertia[body]).cwiseProduct(w)) / 2;
  }
};

template <class Real, bool removes>
struct ApplyCorrections {
  LoopView<Real> loops;
  BodyView<Real> bodies;
  Vector3<Real> gravity;
  Real h;
  StaticImpulse* static_impulses;  ///< by body, or null
  const StepControl* control;
  SIM_HD void operator()(int item) const {
    if (control->overflow) return;
    constexpr Real sign = removes ? Real(-1) : Real(1);
    const std::uint32_t body = loops.bodies[item];
    const Vector3<Real> by = loops.correction[body];
    bodies.velocity[body] = Vector3<Real>(bodies.velocity[body].load() + sign * by);
    // The energy guard adds that of groups that touch something.
    if (removes && static_impulses != nullptr && !loops.is_touching(static_cast<int>(body)))
      static_impulses[body].push_work -= static_cast<double>(h * bodies.mass[body] * gravity.dot(by));
    if (bodies.angular_velocity == nullptr) return;
    bodies.angular_velocity[body] =
        Vector3<Real>(bodies.angular_velocity[body].load() + sign * loops.spin_correction[body].load());
  }
};

/// Rounds: sums of chunks, scaling of groups, velocities of bodies.
template <class Real>
struct LimitLoops {
  LoopView<Real> loops;
  BodyView<Real> bodies;
  LoopMotion<Real> motion;
  Vector3<Real> gravity;
  Real h;
  const StepControl* control;
  static constexpr int rounds = 3;
  SIM_HD std::int64_t items(int round) const {
    if (control->overflow) return 0;
    return round == 0 ? loops.chunk_count : round == 1 ? loops.group_count : loops.body_count;
  }
  SIM_HD void operator()(int round, int item) const {
    if (round == 0)
      sum(item);
    else if (round == 1)
      limit(item);
    else
      slow_down(loops.bodies[item]);
  }

 private:
  SIM_HD static Vector3d wide(const PackedVector3<Real>& v) { return widened<Real>(v.load()); }

  SIM_HD void sum(int chunk) const {
    double gain = 0, kinetic = 0;
    for (std::uint32_t place = loops.chunks[chunk].begin; place < loops.chunks[chunk].end; ++place) {
      const std::uint32_t body = loops.bodies[place];
      const double m = static_cast<double>(bodies.mass[body]);
      const Vector3d v = wide(bodies.velocity[body]), w = wide(motion.start[body]);
      const Vector3d moved = wide(motion.moved[body]) - wide(loops.correction[body]);
      const Vector3<Real> pull =
          motion.field != nullptr ? Vector3<Real>(gravity + motion.field[body]) : gravity;
      const double energy = m / 2 * v.dot(v);
      kinetic += energy;
      gain += energy - m / 2 * w.dot(w) - m * static_cast<double>(h) * widened<Real>(pull).dot(moved);
      if (motion.springs.impulse != nullptr) gain -= wide(motion.springs.impulse[body]).dot(v + w) / 2;
      if (loops.start_spin == nullptr) continue;
      const double rotation = BeginLoops<Real>::rotation_energy(bodies, body);
      kinetic += rotation;
      gain += rotation - loops.start_energy[body];
      if (motion.springs.impulse != nullptr)
        gain -= wide(motion.springs.moment[body])
                    .dot(wide(bodies.angular_velocity[body]) + wide(loops.start_spin[body])) /
                2;
    }
    loops.sums[2 * chunk] = gain;
    loops.sums[2 * chunk + 1] = kinetic;
  }

  SIM_HD void limit(int group) const {
    LoopScaling scaling;
    double gain = 0, kinetic = 0;
    for (std::uint32_t chunk = loops.chunk_begin[group]; chunk < loops.chunk_begin[group + 1]; ++chunk) {
      gain += loops.sums[2 * chunk];
      kinetic += loops.sums[2 * chunk + 1];
    }
    if (is_limited(group) && gain - gain == 0 && kinetic - kinetic == 0) {
      LoopAllowance allowance = loops.allowances[group];
      const double largest = max_of(allowance.largest, kinetic);
      allowance.left += JointLoops<Real>::bound * (largest - allowance.largest) - gain;
      allowance.largest = largest;
      if (allowance.left < 0) {
        const bool held = loops.support_begin[group] < loops.support_begin[group + 1];
        const double available = held ? kinetic : find_rigid_motion(group, scaling.rigid);
        const double kept = available > 0 ? max_of(1 + allowance.left / available, 0.0) : 0.0;
        using std::sqrt;
        scaling.scale = sqrt(kept);
        allowance.left += available * (1 - kept);
      }
      allowance.left = min_of(allowance.left, JointLoops<Real>::bound * largest);
      loops.allowances[group] = allowance;
    }
    loops.scalings[group] = scaling;
  }
  SIM_HD bool is_limited(int group) const {
    if (loops.touches[group] != 0) return false;
    if (motion.asleep != nullptr && motion.asleep[loops.bodies[loops.chunks[loops.chunk_begin[group]].begin]])
      return false;
    for (std::uint32_t k = loops.support_begin[group]; k < loops.support_begin[group + 1]; ++k) {
      const std::uint32_t body = loops.supports[k];
      if (body == PlacedJoint::world) continue;
      const Vector3<Real> v = bodies.velocity[body];
      if (v.dot(v) > 0) return false;
      if (bodies.angular_velocity == nullptr) continue;
      const Vector3<Real> w = bodies.angular_velocity[body];
      if (w.dot(w) > 0) return false;
    }
    return true;
  }
  /// Finds the rigid motion of a group with its momentum and angular momentum. Returns the kinetic energy
  /// relative to it.
  SIM_HD double find_rigid_motion(int group, RigidMotion& rigid) const {
    const std::uint32_t first = loops.chunks[loops.chunk_begin[group]].begin,
                        last = loops.chunks[loops.chunk_begin[group + 1] - 1].end;
    const Vector3d origin = widened<Real>(bodies.position[loops.bodies[first]]);
    RigidSums sums;
    for (std::uint32_t place = first; place < last; ++place) {
      const std::uint32_t body = loops.bodies[place];
      sums.add(static_cast<double>(bodies.mass[body]), widened<Real>(bodies.position[body]) - origin,
               wide(bodies.velocity[body]));
      if (loops.start_spin != nullptr)
        sums.add_rotation(widened<Real>(bodies.inertia[body]), widened<Real>(bodies.orientation[body]),
                          wide(bodies.angular_velocity[body]));
    }
    rigid = sums.motion();
    rigid.centre += origin;
    double relative = 0;
    for (std::uint32_t place = first; place < last; ++place) {
      const std::uint32_t body = loops.bodies[place];
      const Vector3d v =
          wide(bodies.velocity[body]) - rigid.velocity_at(widened<Real>(bodies.position[body]));
      relative += static_cast<double>(bodies.mass[body]) / 2 * v.dot(v);
      if (loops.start_spin == nullptr) continue;
      const Vector3d w = widened<Real>(bodies.orientation[body]).conjugate() *
                         Vector3d(wide(bodies.angular_velocity[body]) - rigid.spin);
      relative += w.dot(widened<Real>(bodies.inertia[body]).cwiseProduct(w)) / 2;
    }
    return relative;
  }

  SIM_HD void slow_down(std::uint32_t body) const {
    const LoopScaling scaling = loops.scalings[loops.group_of[body]];
    if (!(scaling.scale < 1)) return;
    const Vector3d rigid = scaling.rigid.velocity_at(widened<Real>(bodies.position[body]));
    const Vector3d v = rigid + scaling.scale * (wide(bodies.velocity[body]) - rigid);
    bodies.velocity[body] = Vector3<Real>(v.cast<Real>());
    if (loops.start_spin == nullptr) return;
    const Vector3d w =
        scaling.rigid.spin + scaling.scale * (wide(bodies.angular_velocity[body]) - scaling.rigid.spin);
    bodies.angular_velocity[body] = Vector3<Real>(w.cast<Real>());
  }
};

}  // namespace

template <class Real>
JointLoops<Real>::JointLoops(Executor& executor, const BodyView<Real>& bodies, const Vector3<Real>& gravity,
                             StaticImpulse* static_impulses, Real h, const StepControl* control)
    : executor_(executor),
      body_view_(bodies),
      gravity_(gravity),
      static_impulses_(static_impulses),
      h_(h),
      control_(control),
      bodies_(executor, "joint loop bodies"),
      group_of_(executor, "joint loop groups"),
      chunk_begin_(executor, "joint loop chunk starts"),
      supports_(executor, "joint loop supports"),
      support_begin_(executor, "joint loop support starts"),
      touches_(executor, "joint loop touches"),
      chunks_(executor, "joint loop chunks"),
      correction_(executor, "joint corrections"),
      spin_correction_(executor, "joint spin corrections"),
      start_spin_(executor, "joint loop start spins"),
      start_energy_(executor, "joint loop start energies"),
      sums_(executor, "joint loop sums"),
      allowances_(executor, "joint loop allowances"),
      scalings_(executor, "joint loop scalings") {}

template <class Real>
void JointLoops<Real>::upload(const JointLoopGroups& groups, std::size_t body_count) {
  if (groups.count() == 0) return;
  std::vector<std::uint32_t> group_of(body_count, JointLoopGroups::none), chunk_begin{0};
  std::vector<LoopChunk> chunks;
  for (std::uint32_t group = 0; group < groups.count(); ++group) {
    const std::uint32_t end = groups.begin[group + 1];
    for (std::uint32_t at = groups.begin[group]; at < end; at += LoopChunk::size)
      chunks.push_back({at, std::min(at + LoopChunk::size, end)});
    for (std::uint32_t at = groups.begin[group]; at < end; ++at) group_of[groups.bodies[at]] = group;
    chunk_begin.push_back(static_cast<std::uint32_t>(chunks.size()));
  }
  bodies_.upload(groups.bodies);
  group_of_.upload(group_of);
  chunk_begin_.upload(chunk_begin);
  supports_.upload(groups.supports);
  support_begin_.upload(groups.support_begin);
  touches_.upload(std::vector<std::uint32_t>(groups.count(), 0));
  chunks_.upload(chunks);
  reserve_corrections(body_count);
  if (body_view_.orientation != nullptr) {
    start_spin_.resize_discarding(body_count);
    start_energy_.resize_discarding(body_count);
  }
  sums_.resize_discarding(2 * chunks.size());
  allowances_.upload(std::vector<LoopAllowance>(groups.count()));
  scalings_.resize_discarding(groups.count());
}

template <class Real>
void JointLoops<Real>::reserve_corrections(std::size_t body_count) {
  for (Buffer<PackedVector3<Real>>* corrections : {&correction_, &spin_correction_}) {
    corrections->resize_discarding(body_count);
    corrections->fill_zero();
  }
}

template <class Real>
LoopView<Real> JointLoops<Real>::view() const {
  const auto or_null = [](const auto& buffer) { return buffer.size() > 0 ? buffer.data() : nullptr; };
  return {bodies_.data(),
          group_of_.data(),
          chunks_.data(),
          chunk_begin_.data(),
          supports_.data(),
          support_begin_.data(),
          touches_.data(),
          correction_.data(),
          spin_correction_.data(),
          or_null(start_spin_),
          start_energy_.data(),
          sums_.data(),
          allowances_.data(),
          scalings_.data(),
          static_cast<std::uint32_t>(bodies_.size()),
          static_cast<std::uint32_t>(chunks_.size()),
          static_cast<std::uint32_t>(touches_.size())};
}

template <class Real>
BodyView<Real> JointLoops<Real>::corrections() const {
  BodyView<Real> view = body_view_;
  view.velocity = correction_.data();
  view.angular_velocity = spin_correction_.data();
  return view;
}

template <class Real>
void JointLoops<Real>::begin(const ImpulsesByBody<Real>& impulses) {
  if (!empty())
    executor_.run_rounds("joints", 2, static_cast<std::int64_t>(bodies_.size()),
                         BeginLoops<Real>{view(), body_view_, impulses, control_});
}

template <class Real>
void JointLoops<Real>::add_corrections() {
  if (!empty())
    executor_.run(
        "joints", static_cast<std::int64_t>(bodies_.size()),
        ApplyCorrections<Real, false>{view(), body_view_, gravity_, h_, static_impulses_, control_});
}

template <class Real>
void JointLoops<Real>::remove_corrections() {
  if (!empty())
    executor_.run("joints", static_cast<std::int64_t>(bodies_.size()),
                  ApplyCorrections<Real, true>{view(), body_view_, gravity_, h_, static_impulses_, control_});
}

template <class Real>
void JointLoops<Real>::limit_energy(const LoopMotion<Real>& motion) {
  if (!empty())
    executor_.run_rounds("joints", 3, static_cast<std::int64_t>(bodies_.size()),
                         LimitLoops<Real>{view(), body_view_, motion, gravity_, h_, control_});
}

template <class Real>
std::vector<std::array<double, 2>> JointLoops<Real>::save_allowances() const {
  std::vector<std::array<double, 2>> saved;
  if (empty()) return saved;
  for (const LoopAllowance& allowance : allowances_.download())
    saved.push_back({allowance.left, allowance.largest});
  return saved;
}

template <class Real>
void JointLoops<Real>::load_allowances(const std::vector<std::array<double, 2>>& allowances) {
  if (empty() || allowances.size() != allowances_.size()) return;
  std::vector<LoopAllowance> loaded;
  for (const auto& [left, largest] : allowances) loaded.push_back({left, largest});
  allowances_.upload(loaded);
}

template class JointLoops<float>;
template class JointLoops<double>;

}  // namespace collidoscope
