#include "sim_cuda/solver/joint_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim_cuda/core/series.h"

namespace collidoscope {
namespace {

// See joint_constraint.h. A warm-start factor of springs below 1 bounds the accumulated impulse if another
// constraint resists it.
constexpr double error_fraction = 0.8;  ///< of the error of a rigid joint that is corrected per substep
constexpr double alone_spring_factor = 0.95, coupled_spring_factor = 0.9;

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
  const double factor = joint_count > 1 ? coupled_spring_factor : alone_spring_factor;  // of the damping part
  return {scale, bias / h, 1 - scale, 1 - (1 - factor) * scale};
}

JointStiffness<double> stiffness(const PlacedJoint& joint, std::uint32_t joint_count, double h) {
  if (joint.kind == JointKind::spring) return spring(joint, joint_count, h);
  return {1, error_fraction / h, 0, 1};
}

/// A unit vector perpendicular to `axis`.
Vector3d perpendicular_to(const Vector3d& axis) {
  const Vector3d other = std::abs(axis.x()) < 0.6 ? Vector3d(1, 0, 0) : Vector3d(0, 1, 0);
  const Vector3d side = other - other.dot(axis) * axis;
  return side / std::sqrt(side.dot(side));
}

}  // namespace

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

std::vector<std::size_t> colours_of(const std::vector<PlacedJoint>& joints, const std::vector<bool>& in_tree,
                                    const std::vector<bool>& moves) {
  std::vector<std::vector<std::uint64_t>> taken(moves.size());
  std::vector<std::size_t> colours;
  for (const PlacedJoint& joint : joints) {
    if (in_tree[colours.size()]) {
      colours.push_back(0);
      continue;
    }
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

template JointRow<float> row_of(const PlacedJoint&, std::uint32_t, double, double);
template JointRow<double> row_of(const PlacedJoint&, std::uint32_t, double, double);

}  // namespace collidoscope
