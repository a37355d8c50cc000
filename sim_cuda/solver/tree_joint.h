#pragma once
// Equations of one joint of a tree in a substep, in double: position errors at the end of the substep,
// forces, and their derivatives by the velocities of the two bodies. Used by joint_tree_solver.h.
// Short-lived.
//
// A body moves by h (v - h g / 2) and rotates by the Cayley map of h w, where v and w are the velocities of
// the solver. With the scheme energy_momentum these are the mean velocities of the substep. Forces then act
// at the mean anchors and along the mean directions, so that they do no work if the joint keeps its position
// error, for any h (Simo, Wong 1991; Gonzalez 1996; Betsch, Steinmann 2001).
//
// Notation: k = h w / 2. A vector r of the body moves to r1 with r1 - r = h w x (r + r1) / 2. Its derivative
// is dr1 = N (h dw x (r + r1) / 2), N = (1 - [k])^-1.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/dynamics/cayley.h"
#include "sim_cuda/solver/joint_measure.h"

namespace collidoscope {

/// energy_momentum: forces at the mean pose; velocities change by the impulse twice, once before and once
/// after the move. start_pose: forces at the start pose, for trees that touch something; the joint's velocity
/// error is removed after the move. That is RATTLE (Andersen 1983) and fits the iterations of contacts.
/// velocities: the velocity error at the current pose; nothing moves.
enum class TreeScheme { energy_momentum, start_pose, velocities };

SIM_HD inline double length_of(const Vector3d& v) {
  using std::sqrt;
  return sqrt(v.dot(v));
}

/// Motion of a body in the substep.
struct TreeBody {
  bool responds = false;           ///< false: static, kinematic, or the world
  bool turns = false;              ///< true with the effect rotation
  Vector3d position{0, 0, 0};      ///< m, at the start
  Vector3d velocity{0, 0, 0};      ///< m/s
  Vector3d spin{0, 0, 0};          ///< rad/s
  Vector3d half{0, 0, 0};          ///< k
  double scale = 1;                ///< 1 / (1 + k . k)
  Vector3d displacement{0, 0, 0};  ///< m, of the centre
  Quaterniond axes{1, 0, 0, 0};    ///< principal axes to world, at the start
  Vector3d inertia{1, 1, 1};       ///< kg m^2, principal

  /// Change of a vector of the body by the rotation.
  SIM_HD Vector3d change(const Vector3d& r) const {
    const Vector3d c = half.cross(r);
    return 2 * scale * (c + half.cross(c));
  }
  /// N c
  SIM_HD Vector3d tangent(const Vector3d& c) const {
    return scale * (c + half.cross(c) + half.dot(c) * half);
  }
  /// N^T c
  SIM_HD Vector3d tangent_transposed(const Vector3d& c) const {
    return scale * (c - half.cross(c) + half.dot(c) * half);
  }
  SIM_HD Quaterniond next_axes() const {
    Quaterniond next = Quaterniond(1, half.x(), half.y(), half.z()) * axes;
    normalise(next);
    return next;
  }
};

/// A vector of a body during the substep.
struct TurnedVector {
  Vector3d start, next, mean;
  SIM_HD TurnedVector(const TreeBody& body, const Vector3d& own) {
    start = body.turns ? Vector3d(body.axes * own) : own;
    next = body.turns ? Vector3d(start + body.change(start)) : start;
    mean = (start + next) / 2;
  }
};

class TreeJoint {
 public:
  static constexpr int max_rows = 6;
  /// Vectors of the two ends: 0 is a, 1 is b.
  struct Pair {
    Vector3d linear[2], angular[2];
  };

  const JointRow<double>& joint;
  TreeScheme scheme;
  double h;  ///< s
  const TreeBody *a, *b;
  TurnedVector arm_a, arm_b;
  Vector3d separation, next_separation, mean_separation;  ///< m, from a's anchor to b's
  int rows = 0;
  double error_rate[max_rows];  ///< (error at the end - target) / h; velocities: the velocity error
  double correction[max_rows];  ///< speed that corrects the position error at the start
  int impulse_of[max_rows];     ///< index in the impulses of the joint
  Pair force[max_rows];         ///< per unit impulse
  Pair gradient[max_rows];      ///< of the error rate, by velocity and spin

  // Impulses of a joint: 0 to 2 at the point, 0 along the line; 3, 4 perpendicular to the hinge axis; 5
  // limit. A limit pushes up from the lower one if > 0, down from the upper one if < 0.

  /// `impulses`: those of this substep so far. `limit`: -1, 0 or 1, the active limit; updated if `adapt`.
  SIM_HD TreeJoint(const JointRow<double>& row, TreeScheme which, double substep, const TreeBody& body_a,
                   const TreeBody& body_b, double* impulses, int& limit, bool adapt)
      : joint(row),
        scheme(which),
        h(substep),
        a(&body_a),
        b(&body_b),
        arm_a(body_a, row.anchor_a),
        arm_b(body_b, row.b == JointRow<double>::world ? Vector3d(0, 0, 0) : row.anchor_b) {
    separation = (body_b.position - body_a.position) + (arm_b.start - arm_a.start);
    next_separation = separation + (body_b.displacement - body_a.displacement) +
                      ((arm_b.next - arm_b.start) - (arm_a.next - arm_a.start));
    mean_separation =
        scheme == TreeScheme::energy_momentum ? Vector3d((separation + next_separation) / 2) : separation;
    if (joint.kind == JointKind::distance)
      add_line(impulses, limit, adapt);
    else
      add_point();
    if (joint.kind == JointKind::hinge && a->turns) add_hinge(impulses, limit, adapt);
    if (scheme == TreeScheme::velocities)
      for (int row_index = 0; row_index < rows; ++row_index) {
        const Pair& g = gradient[row_index];
        error_rate[row_index] = g.linear[0].dot(a->velocity) + g.angular[0].dot(a->spin) +
                                g.linear[1].dot(b->velocity) + g.angular[1].dot(b->spin);
      }
  }

  /// Derivative of the forces of `impulses` by a component of the velocity (0 to 2) or the spin (3 to 5) of
  /// end `end`. Only for energy_momentum; otherwise 0.
  SIM_HD Pair stiffness(const double* impulses, int end, int component) const {
    Pair change{{Vector3d(0, 0, 0), Vector3d(0, 0, 0)}, {Vector3d(0, 0, 0), Vector3d(0, 0, 0)}};
    if (scheme != TreeScheme::energy_momentum) return change;
    const TreeBody& body = end == 0 ? *a : *b;
    const bool spin = component >= 3;
    const Vector3d e = unit_vector(component % 3);
    const auto turned = [&](const TurnedVector& vector) {
      return spin ? Vector3d(h / 2 * body.tangent(e.cross(vector.mean))) : Vector3d(0, 0, 0);
    };
    const Vector3d none(0, 0, 0);
    const Vector3d arm_a_change = end == 0 ? turned(arm_a) : none,
                   arm_b_change = end == 1 ? turned(arm_b) : none;
    const Vector3d shift = spin ? none : Vector3d(h / 2 * e);  // of the mean position
    const Vector3d between = end == 1 ? Vector3d(shift + arm_b_change) : Vector3d(-shift - arm_a_change);
    Vector3d on_b, on_b_change;
    const Vector3d at_a = point_arm(0), at_b = point_arm(1);
    if (joint.kind == JointKind::distance) {
      const double distance = length_of(mean_separation), total = impulses[0] + impulses[5];
      const Vector3d normal = direction(mean_separation, distance);
      on_b = total * normal;
      on_b_change =
          distance > 0 ? Vector3d(total / distance * (between - normal.dot(between) * normal)) : none;
    } else {
      on_b = Vector3d(impulses[0], impulses[1], impulses[2]);
      on_b_change = none;
    }
    Vector3d moment_a = at_a.cross(on_b), moment_b = at_b.cross(on_b);
    Vector3d moment_a_change = arm_a_change.cross(on_b) + at_a.cross(on_b_change);
    Vector3d moment_b_change = arm_b_change.cross(on_b) + at_b.cross(on_b_change);
    if (joint.kind == JointKind::hinge && a->turns) {
      const Hinge hinge(*this);
      const Vector3d axis_b_change = end == 1 ? turned(hinge.axis_b) : none;
      const TurnedVector* const sides[] = {&hinge.side, &hinge.other};
      for (int k = 0; k < 2; ++k) {
        const double impulse = impulses[3 + k];
        const Vector3d moment = impulse * hinge.axis_b.mean.cross(sides[k]->mean);
        const Vector3d moment_change =
            impulse * (axis_b_change.cross(sides[k]->mean) +
                       (end == 0 ? Vector3d(hinge.axis_b.mean.cross(turned(*sides[k]))) : none));
        moment_a += moment;
        moment_b += moment;
        moment_a_change += moment_change;
        moment_b_change += moment_change;
      }
      const Vector3d moment = impulses[5] * hinge.axis.mean;
      const Vector3d moment_change = end == 0 ? Vector3d(impulses[5] * turned(hinge.axis)) : none;
      moment_a += moment;
      moment_b += moment;
      moment_a_change += moment_change;
      moment_b_change += moment_change;
    }
    change.linear[0] = -on_b_change;
    change.linear[1] = on_b_change;
    if (a->turns) change.angular[0] = -balanced(*a, moment_a_change);
    if (b->turns) change.angular[1] = balanced(*b, moment_b_change);
    if (spin && end == 0 && a->turns) change.angular[0] += h / 2 * e.cross(moment_a);
    if (spin && end == 1 && b->turns) change.angular[1] -= h / 2 * e.cross(moment_b);
    return change;
  }

 private:
  struct Hinge {
    TurnedVector axis, side, other, axis_b;
    SIM_HD explicit Hinge(const TreeJoint& of)
        : axis(*of.a, of.joint.axis_a),
          side(*of.a, of.joint.side),
          other(*of.a, of.joint.axis_a.cross(of.joint.side)),
          axis_b(*of.b, of.joint.axis_b) {}
  };

  SIM_HD static Vector3d direction(const Vector3d& way, double length) {
    return length > 0 ? Vector3d(way / length) : Vector3d(0, 0, 1);
  }
  SIM_HD bool uses_mean() const { return scheme == TreeScheme::energy_momentum; }
  SIM_HD const Vector3d& acting(const TurnedVector& vector) const {
    return uses_mean() ? vector.mean : vector.start;
  }
  /// The moment as it enters the equation of the spin: (1 - [k]) moment with mean velocities.
  SIM_HD Vector3d balanced(const TreeBody& body, const Vector3d& moment) const {
    return uses_mean() ? Vector3d(moment - body.half.cross(moment)) : moment;
  }
  /// Where the force of a point acts: midway between the anchors, which conserves angular momentum. With mean
  /// velocities at the anchors, which conserves energy; both are one point unless a position error is
  /// corrected.
  SIM_HD Vector3d point_arm(int end) const {
    const Vector3d& own = acting(end == 0 ? arm_a : arm_b);
    if (uses_mean() || joint.kind == JointKind::distance || !a->responds || !b->responds) return own;
    return end == 0 ? Vector3d(own + mean_separation / 2) : Vector3d(own - mean_separation / 2);
  }

  SIM_HD int add_row(int impulse, double error, double target, double limit_of_correction) {
    const int row = rows++;
    impulse_of[row] = impulse;
    error_rate[row] = h > 0 ? (error - target) / h : 0;
    correction[row] = h > 0 ? clamp_to(-target / h, -limit_of_correction, limit_of_correction) : 0.0;
    for (int end = 0; end < 2; ++end)
      force[row].linear[end] = force[row].angular[end] = gradient[row].linear[end] =
          gradient[row].angular[end] = Vector3d(0, 0, 0);
    return row;
  }
  /// A force along `acts` on b at the anchor, and the error's gradient along `measured`.
  SIM_HD void set_force(int row, const Vector3d& acts, const Vector3d& measured) {
    const TreeBody* const bodies[] = {a, b};
    const TurnedVector* const arms[] = {&arm_a, &arm_b};
    for (int end = 0; end < 2; ++end) {
      const double sign = end == 0 ? -1 : 1;
      const TreeBody& body = *bodies[end];
      const Vector3d at = point_arm(end);
      force[row].linear[end] = sign * acts;
      gradient[row].linear[end] = sign * measured;
      if (!body.turns) continue;
      force[row].angular[end] = sign * balanced(body, at.cross(acts));
      const Vector3d& moved = scheme == TreeScheme::velocities ? at : arms[end]->mean;
      gradient[row].angular[end] = sign * moved.cross(body.tangent_transposed(measured));
    }
  }
  SIM_HD void set_moment(int row, const Vector3d& acts, const Vector3d& gradient_a,
                         const Vector3d& gradient_b) {
    force[row].angular[0] = -balanced(*a, acts);
    force[row].angular[1] = balanced(*b, acts);
    gradient[row].angular[0] = gradient_a;
    gradient[row].angular[1] = gradient_b;
  }

  SIM_HD void add_point() {
    for (int k = 0; k < 3; ++k) {
      const int row = add_row(k, next_separation[k], separation[k], joint.max_correction_speed);
      set_force(row, unit_vector(k), unit_vector(k));
    }
  }

  /// Updates `limit`: -1 at the upper limit, 1 at the lower one, 0 between. `above`, `below`: distances from
  /// the lower and the upper limit, at the start and at the end.
  SIM_HD void adapt_limit(double* impulses, int& limit, double above, double below, double next_above,
                          double next_below) const {
    if (limit != 0 && impulses[5] * limit < 0) {
      limit = 0;
      impulses[5] = 0;
    } else if (limit == 0) {
      if (next_above < min_of(above, 0.0))
        limit = 1;
      else if (next_below < min_of(below, 0.0))
        limit = -1;
    }
  }

  SIM_HD void add_line(double* impulses, int& limit, bool adapt) {
    const double start = length_of(separation), next = length_of(next_separation);
    const Vector3d acts = direction(mean_separation, length_of(mean_separation));
    const Vector3d measured = scheme == TreeScheme::velocities ? acts : direction(next_separation, next);
    if (joint.low == joint.high) {
      set_force(add_row(0, next - joint.low, start - joint.low, joint.max_correction_speed), acts, measured);
      return;
    }
    if (adapt)
      adapt_limit(impulses, limit, start - joint.low, joint.high - start, next - joint.low,
                  joint.high - next);
    if (limit == 0) return;
    const double bound = limit > 0 ? joint.low : joint.high;
    const double before = start - bound;
    const double target = limit > 0 ? min_of(before, 0.0) : max_of(before, 0.0);
    set_force(add_row(5, next - bound, target, joint.max_correction_speed), acts, measured);
  }

  SIM_HD void add_hinge(double* impulses, int& limit, bool adapt) {
    const Hinge hinge(*this);
    constexpr double fastest = JointRow<double>::max_correction_rate;
    const TurnedVector* const sides[] = {&hinge.side, &hinge.other};
    for (int k = 0; k < 2; ++k) {
      const TurnedVector& side = *sides[k];
      const int row =
          add_row(3 + k, side.next.dot(hinge.axis_b.next), side.start.dot(hinge.axis_b.start), fastest);
      set_moment(row, acting(hinge.axis_b).cross(acting(side)),
                 acting_mean(side).cross(a->tangent_transposed(last(hinge.axis_b))),
                 acting_mean(hinge.axis_b).cross(b->tangent_transposed(last(side))));
    }
    if (!joint.limited) return;
    const HingeLimitGap<double> gap(joint, a->axes, b->axes);
    const HingeLimitGap<double> next_gap =
        scheme == TreeScheme::velocities ? gap : HingeLimitGap<double>(joint, a->next_axes(), b->next_axes());
    const bool locked = joint.low_cosine == joint.high_cosine && joint.low_sine == joint.high_sine;
    if (locked)
      limit = 1;
    else if (adapt)
      adapt_limit(impulses, limit, gap.above, gap.below, next_gap.above, next_gap.below);
    if (limit == 0) return;
    const double start = limit > 0 ? gap.above : -gap.below,
                 next = limit > 0 ? next_gap.above : -next_gap.below;
    const double target = locked ? start : limit > 0 ? min_of(start, 0.0) : max_of(start, 0.0);
    const double slope = limit > 0 ? next_gap.above_slope : next_gap.below_slope;
    const Vector3d axis = scheme == TreeScheme::velocities ? hinge.axis.start : hinge.axis.next;
    set_moment(add_row(5, next, target, fastest), acting(hinge.axis), -slope * axis, slope * axis);
  }
  SIM_HD const Vector3d& last(const TurnedVector& vector) const {
    return scheme == TreeScheme::velocities ? vector.start : vector.next;
  }
  SIM_HD const Vector3d& acting_mean(const TurnedVector& vector) const {
    return scheme == TreeScheme::velocities ? vector.start : vector.mean;
  }
};

}  // namespace collidoscope
