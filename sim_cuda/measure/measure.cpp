#include "sim_cuda/measure/measure.h"

#include <cmath>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/dynamics/wide_spin.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"

namespace collidoscope {

SIM_HD inline BodySums combine(const BodySums& a, const BodySums& b) {
  BodySums s;
  s.kinetic = a.kinetic + b.kinetic;
  s.potential = a.potential + b.potential;
  s.momentum = a.momentum + b.momentum;
  s.angular_momentum = a.angular_momentum + b.angular_momentum;
  s.wall_impulse = a.wall_impulse + b.wall_impulse;
  s.wall_vector = a.wall_vector + b.wall_vector;
  s.push_work = a.push_work + b.push_work;
  s.max_speed_squared = max_of(a.max_speed_squared, b.max_speed_squared);
  s.max_depth = max_of(a.max_depth, b.max_depth);
  s.non_finite = a.non_finite + b.non_finite;
  s.escaped = a.escaped + b.escaped;
  return s;
}

template <class Real>
struct MeasureBody {
  BodyView<Real> bodies;
  const StaticImpulse* static_impulses;  ///< null without walls
  const WallPlane<Real>* planes;
  int plane_count;
  BoxView<Real> boxes;
  Vector3d gravity;  ///< m/s^2
  AttractorView<Real> attractors;
  double ground;  ///< z of zero potential energy, m
  bool with_container;
  Vector3d low, high;  ///< corners of the box, m

  SIM_HD BodySums operator()(std::int64_t body) const {
    const Vector3d x = bodies.position[body].template cast<double>(),
                   v = bodies.velocity[body].load().template cast<double>();
    const bool moved = bodies.inverse_mass[body] == 0;  // static or kinematic
    const double m = static_cast<double>(bodies.mass[body]), r = static_cast<double>(bodies.radius[body]);
    BodySums s;
    bool whole = true;
    for (int k = 0; k < 3; ++k) whole = whole && finite(x[k]) && finite(v[k]);
    s.kinetic = m * v.dot(v) / 2;
    s.potential = -m * gravity.dot(x - Vector3d(0, 0, ground));
    for (int k = 0; k < attractors.count; ++k) s.potential += m * attractors.points[k].potential(x);
    s.momentum = m * v;
    s.angular_momentum = x.cross(s.momentum);
    if (bodies.orientation != nullptr) {
      const Quaterniond q = bodies.orientation[body].template cast<double>();
      const Vector3d w = bodies.angular_velocity[body].load().template cast<double>();
      const Vector3d inertia =
          moved ? Vector3d(0, 0, 0) : Vector3d(bodies.inertia[body].template cast<double>());
      const Vector3d w_body = q.conjugate() * w;
      const Vector3d l_body(inertia.x() * w_body.x(), inertia.y() * w_body.y(), inertia.z() * w_body.z());
      s.kinetic += w_body.dot(l_body) / 2;
      s.angular_momentum += q * l_body;
      for (int k = 0; k < 3; ++k) whole = whole && finite(w[k]) && finite(q.coeffs()[k]);
      whole = whole && finite(q.w());
    }
    s.wall_impulse = s.push_work = 0;
    s.wall_vector = Vector3d(0, 0, 0);
    if (static_impulses != nullptr) {
      s.wall_impulse = static_impulses[body].impulse;
      s.wall_vector = Vector3d(static_impulses[body].vector[0], static_impulses[body].vector[1],
                               static_impulses[body].vector[2]);
      s.push_work = static_impulses[body].push_work;
    }
    s.max_speed_squared = v.dot(v);
    s.max_depth = 0;
    for (int p = 0; !moved && p < plane_count; ++p) {
      const double gap =
          planes[p].normal.template cast<double>().dot(x) - static_cast<double>(planes[p].offset) - r;
      s.max_depth = max_of(s.max_depth, -gap);
    }
    for (int b = 0; !moved && b < boxes.count; ++b)
      s.max_depth = max_of(
          s.max_depth, -static_cast<double>(boxes.boxes[b].gap(bodies.position[body], bodies.radius[body])));
    s.non_finite = whole ? 0 : 1;
    s.escaped = 0;
    if (with_container) {
      bool inside = true;
      for (int k = 0; k < 3; ++k) inside = inside && x[k] >= low[k] && x[k] <= high[k];
      s.escaped = inside || moved ? 0 : 1;
    }
    return s;
  }
};

SIM_HD inline Largest combine(Largest a, Largest b) { return {max_of(a.value, b.value)}; }

/// Overlap depth of the two bodies of a contact at the current poses.
template <class Real>
struct MeasureDepth {
  const Pair* contacts;
  const StepControl* control;
  SphereView<Real> spheres;
  SIM_HD Largest operator()(std::int64_t contact) const {
    if (contact >= static_cast<std::int64_t>(control->contacts)) return {0};
    const auto [a, b] = contacts[contact];
    const Real gap =
        separate<Real>(spheres.position[a], spheres.radius[a], spheres.position[b], spheres.radius[b]).gap;
    return {max_of(0.0, -static_cast<double>(gap))};
  }
};

template <class Real>
struct MeasureImpulse {
  ImpulseView<Real> impulses;
  SIM_HD Largest operator()(std::int64_t contact) const {
    if (contact >= static_cast<std::int64_t>(*impulses.count)) return {0};
    return {static_cast<double>(impulses.impulse[contact])};
  }
};

template <class Real>
struct HashState {
  BodyView<Real> bodies;
  const Vector3<float>* low;  ///< null: there are none
  std::int64_t body_count;
  HashedArrays others;
  /// `array`: see HashedArrays::hash().
  SIM_HD HashSums operator()(std::int64_t item, int& array) const {
    if (item >= body_count) return {0, others.hash(item - body_count, array)};
    const std::uint64_t h = of_body(item);
    if constexpr (sizeof(Real) == sizeof(float)) {
      if (low == nullptr) return {h, 0};
      const Vector3d w = joined(bodies.angular_velocity[item], low[item]);
      return {h, mix64(h ^ mix64(hash_bits(w.x()) ^ mix64(hash_bits(w.y()) ^ mix64(hash_bits(w.z())))))};
    }
    return {h, 0};
  }

 private:
  SIM_HD std::uint64_t of_body(std::int64_t body) const {
    std::uint64_t h = mix64(static_cast<std::uint64_t>(body));
    const auto add = [&h](Real x) { h = mix64(h ^ hash_bits(x)); };
    const auto add_vector = [&](const Vector3<Real>& x) {
      for (int k = 0; k < 3; ++k) add(x[k]);
    };
    const bool turns = bodies.orientation != nullptr;
    add_vector(bodies.position[body]);
    const Quaternion<Real> q = turns ? bodies.orientation[body] : Quaternion<Real>(1, 0, 0, 0);
    add(q.w());
    add(q.x());
    add(q.y());
    add(q.z());
    add_vector(bodies.velocity[body]);
    add_vector(turns ? bodies.angular_velocity[body].load() : Vector3<Real>(0, 0, 0));
    return h;
  }
};

/// Adds the hashes of items first, first + stride, ... The sum of integers does not depend on the order.
template <class Real>
struct AddHashes {
  HashState<Real> hash_of;
  std::int64_t items, lanes, per_lane;
  bool interleaved;     ///< neighbouring lanes read neighbouring items, as a GPU needs it
  std::uint64_t* sums;  ///< HashSums::bodies, others
  SIM_HD void operator()(int lane) const {
    const std::int64_t first = interleaved ? lane : lane * per_lane, stride = interleaved ? lanes : 1;
    std::uint64_t sum[2] = {0, 0};
    int array = 0;
    for (std::int64_t k = 0; k < per_lane && first + k * stride < items; ++k) {
      const HashSums hash = hash_of(first + k * stride, array);
      sum[0] += hash.bodies;
      sum[1] += hash.others;
    }
    atomic_add_aggregated<2>(sums, sum);
  }
};

template <class Real>
Measurer<Real>::Measurer(Executor& executor)
    : executor_(executor), sums_(executor, "sums"), largest_(executor, "extremes") {}

template <class Real>
void Measurer<Real>::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  sums_.resize_discarding(reduce_scratch_size(bodies));
  largest_.resize_discarding(reduce_scratch_size(contact_capacity));
}

template <class Real>
void Measurer<Real>::measure(const MeasureSource<Real>& source, StepStats& stats) {
  if (source.body_count == 0) return;
  const std::optional<Box>& box = source.box;
  const MeasureBody<Real> load{source.bodies,
                               source.static_impulses,
                               source.planes,
                               source.plane_count,
                               source.boxes,
                               source.gravity,
                               source.attractors,
                               box ? box->min.z() : 0.0,
                               box.has_value(),
                               box ? box->min : Vector3d(0, 0, 0),
                               box ? box->max : Vector3d(0, 0, 0)};
  BodySums sums;
  executor_.copy_to_host(&sums, reduce<BodySums>(executor_, "measure", source.body_count, load, sums_.data()),
                         sizeof sums);
  const auto largest = [&](const auto& load_contact) {
    Largest result{0};
    if (source.contact_capacity > 0)
      executor_.copy_to_host(
          &result,
          reduce<Largest>(executor_, "measure", source.contact_capacity, load_contact, largest_.data()),
          sizeof result);
    return result.value;
  };
  const double depth = largest(MeasureDepth<Real>{
      source.contacts.bodies, source.control, {source.bodies.position, source.bodies.radius}});
  stats.max_impulse = source.impulses.count ? largest(MeasureImpulse<Real>{source.impulses}) : 0;
  stats.kinetic_energy = sums.kinetic;
  stats.potential_energy = sums.potential;
  stats.push_work = sums.push_work;
  for (int k = 0; k < 3; ++k) {
    stats.momentum[k] = sums.momentum[k];
    stats.angular_momentum[k] = sums.angular_momentum[k];
    stats.wall_impulse_vector[k] = sums.wall_vector[k];
  }
  stats.wall_impulse = sums.wall_impulse;
  stats.max_penetration = max_of(sums.max_depth, depth);
  stats.max_speed = std::sqrt(sums.max_speed_squared);
  stats.non_finite = sums.non_finite;
  stats.escaped = sums.escaped;
}

template <class Real>
void Measurer<Real>::add_hashes(const char* stage, const BodyView<Real>& bodies, std::int64_t body_count,
                                const Vector3<float>* low, const HashedArrays& others, std::uint64_t* sums) {
  const std::int64_t items = body_count + others.items(), per_lane = executor_.on_device() ? 8 : 512,
                     lanes = (items + per_lane - 1) / per_lane;
  executor_.run(stage, lanes,
                AddHashes<Real>{
                    {bodies, low, body_count, others}, items, lanes, per_lane, executor_.on_device(), sums});
}

void add(const JointSums& sums, std::int64_t count, StepStats& stats) {
  stats.joints = count;
  stats.max_joint_error = sums.error;
  stats.max_joint_angle = sums.angle;
  stats.spring_energy = sums.energy;
  stats.potential_energy += sums.energy;
}

void add(const SleepSums& sums, StepStats& stats) {
  stats.can_sleep = true;
  stats.asleep = sums.asleep;
  stats.islands = sums.islands;
  stats.islands_asleep = sums.islands_asleep;
}

template class Measurer<float>;
template class Measurer<double>;

}  // namespace collidoscope
