#include "sim_cuda/solver/joints.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/core/series.h"
#include "sim_cuda/solver/joint_constraint.h"

namespace collidoscope {

namespace {

// See joint_constraint.h. A single rigid joint is exact after one visit. A warm-start factor below 1 bounds
// the accumulated impulse if another constraint resists it.
constexpr double alone_warm_start_factor = 0.95;
constexpr double coupled_error_fraction =
    0.4;  ///< of the error, per substep; divided by the largest number of joints at a body
constexpr double coupled_warm_start_factor = 0.9;
constexpr double radii_per_second = 50;

constexpr double full_turn = 6.283185307179586;

/// Phase angle of a spring per substep, rad. `joint_count`: largest number of joints at one of its bodies.
/// See joint_constraint.h.
double spring_angle(const PlacedJoint& joint, std::uint32_t joint_count, double h) {
  return std::min(full_turn * joint.frequency * h, 1 / std::sqrt(joint_count));
}

JointStiffness<double> spring(const PlacedJoint& joint, std::uint32_t joint_count, double h) {
  const double angle = spring_angle(joint, joint_count, h), z = joint.damping_ratio;
  const double scale = -expm1_series(-2 * z * angle);
  double bias = 0;  // (1 - p1) (1 - p2)
  if (z < 1) {
    const double decayed = -expm1_series(-z * angle);  // 1 - e
    const double half = cosine_sine(std::sqrt(1 - z * z) * angle / 2).sine;
    bias = decayed * decayed + 4 * (1 - decayed) * half * half;  // 1 - 2 e c + e^2
  } else {
    const double fast = z + std::sqrt(z * z - 1);
    bias = expm1_series(-angle * fast) * expm1_series(-angle / fast);
  }
  const double factor =
      joint_count > 1 ? coupled_warm_start_factor : alone_warm_start_factor;  // of the damping part
  return {scale, bias / h, 1 - scale, 1 - (1 - factor) * scale};
}

JointStiffness<double> stiffness(const PlacedJoint& joint, std::uint32_t joint_count, double h) {
  if (joint.kind == JointKind::spring) return spring(joint, joint_count, h);
  return joint_count > 1 ? JointStiffness<double>{1, coupled_error_fraction / (joint_count * h), 0,
                                                  coupled_warm_start_factor}
                         : JointStiffness<double>{1, 1 / h, 0, alone_warm_start_factor};
}

/// A unit vector perpendicular to `axis`.
Vector3d perpendicular_to(const Vector3d& axis) {
  const Vector3d other = std::abs(axis.x()) < 0.6 ? Vector3d(1, 0, 0) : Vector3d(0, 1, 0);
  const Vector3d side = other - other.dot(axis) * axis;
  return side / std::sqrt(side.dot(side));
}

template <class Real>
JointRow<Real> row_of(const PlacedJoint& joint, std::uint32_t joint_count, double max_correction_speed,
                      double h) {
  const auto narrow = [](const Vector3d& v) { return Vector3<Real>(v.cast<Real>()); };
  const JointStiffness<double> s = stiffness(joint, joint_count, h);
  JointRow<Real> row{};
  row.a = joint.a;
  row.b = joint.b;
  row.kind = joint.kind;
  row.limited = joint.limited;
  row.anchor_a = narrow(joint.anchor_a);
  row.anchor_b = narrow(joint.anchor_b);
  row.max_correction_speed = static_cast<Real>(max_correction_speed);
  row.stiffness = {static_cast<Real>(s.mass_scale), static_cast<Real>(s.bias_rate),
                   static_cast<Real>(s.impulse_scale), static_cast<Real>(s.warm_start_factor)};
  row.low = static_cast<Real>(joint.low);
  row.high = static_cast<Real>(joint.high);
  const double frequency = spring_angle(joint, joint_count, h) / h;
  row.spring = joint.kind == JointKind::spring ? static_cast<Real>(frequency * frequency) : Real(0);
  row.axis_a = narrow(joint.axis);
  row.axis_b = narrow(joint.start.conjugate() * joint.axis);
  row.side = narrow(perpendicular_to(joint.axis));
  row.start = joint.start.cast<Real>();
  const CosineSine low = cosine_sine(joint.low_angle / 2), high = cosine_sine(joint.high_angle / 2);
  row.low_cosine = static_cast<Real>(low.cosine);
  row.low_sine = static_cast<Real>(low.sine);
  row.high_cosine = static_cast<Real>(high.cosine);
  row.high_sine = static_cast<Real>(high.sine);
  return row;
}

/// Colour of each joint, first fit in scene order. `moves`: by body, true if dynamic.
std::vector<std::size_t> colour(const std::vector<PlacedJoint>& joints, const std::vector<bool>& moves) {
  std::vector<std::vector<std::uint64_t>> taken(moves.size());
  std::vector<std::size_t> colours;
  for (const PlacedJoint& joint : joints) {
    const auto words = [&](std::uint32_t body) {
      return body != PlacedJoint::world && moves[body] ? &taken[body] : nullptr;
    };
    std::vector<std::uint64_t>*const a = words(joint.a), *const b = words(joint.b);
    std::size_t word = 0;
    std::uint64_t used = 0;
    for (;; ++word) {
      used = (a && word < a->size() ? (*a)[word] : 0) | (b && word < b->size() ? (*b)[word] : 0);
      if (~used != 0) break;
    }
    const auto bit = static_cast<std::size_t>(std::countr_one(used));
    for (std::vector<std::uint64_t>* body : {a, b}) {
      if (body == nullptr) continue;
      if (body->size() <= word) body->resize(word + 1, 0);
      (*body)[word] |= std::uint64_t{1} << bit;
    }
    colours.push_back(64 * word + bit);
  }
  return colours;
}

// ---- stages ----

}  // namespace

template <class Real>
struct JointRounds {
  JointView<Real> joints;
  BodyView<Real> bodies;
  Real h;
  const StepControl* control;
  const std::uint8_t* asleep;  ///< by body; null without the effect sleeping
  static constexpr bool static_item_counts = true;
  SIM_HD std::int64_t items(int round) const {
    return control->overflow ? 0 : joints.begin[round + 1] - joints.begin[round];
  }
  SIM_HD std::size_t place(int round, int item) const {
    return joints.begin[round] + static_cast<std::uint32_t>(item);
  }
  SIM_HD bool sleeps(const JointRow<Real>& joint) const {
    return asleep != nullptr && (asleep[joint.a] || (joint.b != PlacedJoint::world && asleep[joint.b]));
  }
};

namespace {

template <class Real, bool with_rotation>
struct WarmStartJoints : JointRounds<Real> {
  SIM_HD void operator()(int round, int item) const {
    const std::size_t place = this->place(round, item);
    const JointRow<Real>& joint = this->joints.rows[place];
    if (this->sleeps(joint)) return;
    JointImpulse<Real> accumulated = this->joints.impulses[place];
    JointEnds<Real, with_rotation> ends(this->bodies, joint);
    JointConstraint<Real, with_rotation>(joint, accumulated, ends, this->h).warm_start();
    ends.store(this->bodies, joint);
    this->joints.impulses[place] = accumulated;
  }
};

template <class Real, bool with_rotation, JointPhase phase>
struct IterateJoints : JointRounds<Real> {
  SIM_HD void operator()(int round, int item) const {
    const std::size_t place = this->place(round, item);
    const JointRow<Real>& joint = this->joints.rows[place];
    if (this->sleeps(joint) || (phase == JointPhase::relax && joint.kind == JointKind::spring)) return;
    JointImpulse<Real> accumulated = this->joints.impulses[place];
    JointEnds<Real, with_rotation> ends(this->bodies, joint);
    JointConstraint<Real, with_rotation>(joint, accumulated, ends, this->h).template iterate<phase>();
    ends.store(this->bodies, joint);
    this->joints.impulses[place] = accumulated;
  }
};

template <class Real, bool with_rotation>
struct MeasureJoint {
  JointView<Real> joints;
  BodyView<Real> bodies;
  SIM_HD JointSums operator()(std::int64_t place) const {
    return measure_joint<Real, with_rotation>(bodies, joints.rows[place]);
  }
};

}  // namespace

template <class Real>
Joints<Real>::Joints(Executor& executor, const std::vector<PlacedJoint>& joints, const InitialBodies& initial,
                     const BodyView<Real>& bodies, Real h, const StepControl* control)
    : executor_(executor),
      bodies_(bodies),
      h_(h),
      control_(control),
      rows_(executor, "joints"),
      impulses_(executor, "joint impulses"),
      begin_(executor, "joint colour starts"),
      is_jointed_(executor, "bodies with joints"),
      excluded_pairs_(executor, "pairs excluded by joints"),
      sums_(executor, "joint sums") {
  if (joints.empty()) return;
  std::vector<bool> moves(initial.size(), true);
  for (std::size_t body = 0; body < initial.motion.size(); ++body)
    moves[body] = initial.motion[body] == Motion::dynamic;
  std::vector<std::uint32_t> joints_of(initial.size(), 0);
  const auto each_body = [&](const PlacedJoint& joint, const auto& visit_body) {
    visit_body(joint.a);
    if (joint.b != PlacedJoint::world) visit_body(joint.b);
  };
  for (const PlacedJoint& joint : joints)
    each_body(joint, [&](std::uint32_t body) { joints_of[body] += moves[body]; });
  std::vector<std::uint8_t> is_jointed(initial.size(), 0);
  std::ranges::transform(joints_of, is_jointed.begin(), [](std::uint32_t n) { return n > 0 ? 1 : 0; });
  is_jointed_.upload(is_jointed);

  const std::vector<std::size_t> colours = colour(joints, moves);
  colours_ = static_cast<int>(*std::ranges::max_element(colours)) + 1;
  std::vector<std::uint32_t> begin(static_cast<std::size_t>(colours_) + 1, 0);
  for (const std::size_t c : colours) ++begin[c + 1];
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
    max_joints_per_colour_ = std::max<std::int64_t>(max_joints_per_colour_, begin[c + 1]);
    begin[c + 1] += begin[c];
  }
  std::vector<JointRow<Real>> rows(joints.size());
  std::vector<std::uint32_t> next = begin;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    std::uint32_t joint_count = 1;
    double max_correction_speed = std::numeric_limits<double>::infinity();
    each_body(joints[k], [&](std::uint32_t body) {
      max_correction_speed = std::min(max_correction_speed, radii_per_second * initial.radius[body]);
    });
    each_body(joints[k], [&](std::uint32_t body) { joint_count = std::max(joint_count, joints_of[body]); });
    const std::size_t place = next[colours[k]]++;
    rows[place] = row_of<Real>(joints[k], joint_count, max_correction_speed, static_cast<double>(h));
    scene_order_.push_back(place);
  }
  std::vector<Pair> excluded_pairs;
  for (const PlacedJoint& joint : joints)
    if (!joint.collide && joint.b != PlacedJoint::world)
      excluded_pairs.push_back({std::min(joint.a, joint.b), std::max(joint.a, joint.b)});
  std::ranges::sort(excluded_pairs, {}, [](const Pair& pair) { return std::pair(pair.a, pair.b); });
  excluded_pairs_.upload(excluded_pairs);
  rows_.upload(rows);
  begin_.upload(begin);
  impulses_.resize_discarding(joints.size());
  impulses_.fill_zero();
  sums_.resize_discarding(reduce_scratch_size(count()));
}

template <class Real>
JointRounds<Real> Joints<Real>::rounds() const {
  return {view(), bodies_, h_, control_, asleep_};
}

template <class Real>
template <class Stage, class StageWithRotation>
void Joints<Real>::run() {
  bodies_.orientation != nullptr
      ? executor_.run_rounds("joints", colours_, max_joints_per_colour_, StageWithRotation{rounds()})
      : executor_.run_rounds("joints", colours_, max_joints_per_colour_, Stage{rounds()});
}

template <class Real>
void Joints<Real>::warm_start() {
  run<WarmStartJoints<Real, false>, WarmStartJoints<Real, true>>();
}

template <class Real>
void Joints<Real>::solve() {
  constexpr JointPhase phase = JointPhase::solve;
  run<IterateJoints<Real, false, phase>, IterateJoints<Real, true, phase>>();
}

template <class Real>
void Joints<Real>::relax() {
  constexpr JointPhase phase = JointPhase::relax;
  run<IterateJoints<Real, false, phase>, IterateJoints<Real, true, phase>>();
}

template <class Real>
JointSums Joints<Real>::measure() {
  const auto with = [&](const auto& load) {
    JointSums sums;
    executor_.copy_to_host(&sums, reduce<JointSums>(executor_, "measure", count(), load, sums_.data()),
                           sizeof sums);
    return sums;
  };
  return bodies_.orientation != nullptr ? with(MeasureJoint<Real, true>{view(), bodies_})
                                        : with(MeasureJoint<Real, false>{view(), bodies_});
}

template <class Real>
std::vector<WarmStartJoint> Joints<Real>::save_warm_start() const {
  const std::vector<JointRow<Real>> rows = rows_.download();
  const std::vector<JointImpulse<Real>> impulses = impulses_.download();
  std::vector<WarmStartJoint> warm_start;
  for (const std::size_t place : scene_order_) {
    const JointRow<Real>& row = rows[place];
    const JointImpulse<Real>& p = impulses[place];
    warm_start.push_back({row.a, row.b, static_cast<std::uint64_t>(row.kind), {}});
    const Real parts[] = {p.linear.x(), p.linear.y(),       p.linear.z(),      p.lower,
                          p.upper,      p.perpendicular[0], p.perpendicular[1]};
    std::ranges::copy(parts, warm_start.back().impulse.begin());
  }
  return warm_start;
}

template <class Real>
void Joints<Real>::load_warm_start(const std::vector<WarmStartJoint>& warm_start) {
  if (count() == 0) return;
  const std::vector<JointRow<Real>> rows = rows_.download();
  std::vector<JointImpulse<Real>> impulses(rows.size());
  // Both lists are in scene order. Joints in only one of them are skipped.
  std::size_t known = 0;
  for (const std::size_t place : scene_order_) {
    const JointRow<Real>& row = rows[place];
    const auto found =
        std::find_if(warm_start.begin() + static_cast<std::ptrdiff_t>(known), warm_start.end(),
                     [&](const WarmStartJoint& m) {
                       return m.kind == static_cast<std::uint64_t>(row.kind) && m.a == row.a && m.b == row.b;
                     });
    std::array<Real, 7> part{};
    if (found != warm_start.end()) {
      known = static_cast<std::size_t>(found - warm_start.begin()) + 1;
      for (std::size_t k = 0; k < part.size(); ++k) part[k] = static_cast<Real>(found->impulse[k]);
    }
    impulses[place] = {{part[0], part[1], part[2]}, part[3], part[4], {part[5], part[6]}};
  }
  impulses_.upload(impulses);
}

template class Joints<float>;
template class Joints<double>;

}  // namespace collidoscope
