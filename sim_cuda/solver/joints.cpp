#include "sim_cuda/solver/joints.h"

#include <algorithm>
#include <array>
#include <limits>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/solver/joint_rows.h"
#include "sim_cuda/solver/joint_stages.h"

namespace collidoscope {

namespace {

constexpr double radii_per_second = 50;  ///< largest speed of the correction of errors

}  // namespace

template <class Real>
Joints<Real>::Joints(Executor& executor, const std::vector<PlacedJoint>& joints, const InitialBodies& initial,
                     const BodyView<Real>& bodies, const Vector3<Real>& gravity,
                     StaticImpulse* static_impulses, Real h, const StepControl* control)
    : executor_(executor),
      bodies_(bodies),
      gravity_(gravity),
      static_impulses_(static_impulses),
      h_(h),
      control_(control),
      rows_(executor, "joints"),
      impulses_(executor, "joint impulses"),
      begin_(executor, "joint colour starts"),
      nodes_(executor, "joint tree nodes"),
      tree_begin_(executor, "joint tree starts"),
      tree_size_(executor, "joint tree sizes"),
      node_states_(executor, "joint tree states"),
      closings_(executor, "closing joints"),
      closing_begin_(executor, "closing joint starts"),
      closing_states_(executor, "closing joint states"),
      columns_(executor, "closing joint columns"),
      members_(executor, "joint tree members"),
      loops_(executor, bodies, gravity, static_impulses, h, control),
      spring_bodies_(executor, "bodies with springs"),
      spring_impulse_(executor, "spring impulses"),
      spring_moment_(executor, "spring moments"),
      is_jointed_(executor, "bodies with joints"),
      excluded_pairs_(executor, "pairs excluded by joints"),
      sums_(executor, "joint sums") {
  if (joints.empty()) return;
  const std::vector<bool> moves = bodies_that_respond(initial);
  trees_ = find_joint_trees(joints, moves);
  find_spin_axes(
      trees_, joints,
      initial.inertia.empty() ? std::vector<Vector3d>(initial.size(), Vector3d(1, 1, 1)) : initial.inertia);
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

  loops_.upload(find_joint_loops(joints, trees_.in_tree, moves), initial.size());
  upload_springs(joints, moves);

  const std::vector<std::size_t> colours = colours_of(joints, trees_.in_tree, moves);
  if (std::ranges::count(trees_.in_tree, false) > 0)
    colours_ = static_cast<int>(*std::ranges::max_element(colours)) + 1;
  std::vector<std::uint32_t> begin(static_cast<std::size_t>(colours_) + 1, 0);
  for (std::size_t k = 0; k < joints.size(); ++k)
    if (!trees_.in_tree[k]) ++begin[colours[k] + 1];
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
    max_joints_per_colour_ = std::max<std::int64_t>(max_joints_per_colour_, begin[c + 1]);
    begin[c + 1] += begin[c];
  }
  std::vector<JointRow<Real>> rows(joints.size());
  std::vector<std::uint32_t> next = begin;  // then the joints of trees, in scene order
  for (std::size_t k = 0; k < joints.size(); ++k) {
    std::uint32_t joint_count = 1;
    double max_correction_speed = std::numeric_limits<double>::infinity();
    each_body(joints[k], [&](std::uint32_t body) {
      max_correction_speed = std::min(max_correction_speed, radii_per_second * initial.radius[body]);
    });
    each_body(joints[k], [&](std::uint32_t body) { joint_count = std::max(joint_count, joints_of[body]); });
    const std::size_t place = next[trees_.in_tree[k] ? static_cast<std::size_t>(colours_) : colours[k]]++;
    rows[place] =
        row_of<Real>(joints[k], initial, moves, joint_count, max_correction_speed, static_cast<double>(h));
    scene_order_.push_back(place);
  }
  std::vector<Pair> excluded_pairs;
  for (const PlacedJoint& joint : joints)
    if (!joint.collide && joint.b != PlacedJoint::world)
      excluded_pairs.push_back({std::min(joint.a, joint.b), std::max(joint.a, joint.b)});
  std::ranges::sort(excluded_pairs, {}, [](const Pair& pair) { return std::pair(pair.a, pair.b); });
  excluded_pairs_.upload(excluded_pairs);
  rows_.upload(rows);
  upload_trees(initial);
  begin_.upload(begin);
  impulses_.resize_discarding(joints.size());
  impulses_.fill_zero();
  sums_.resize_discarding(reduce_scratch_size(count()));
}

template <class Real>
void Joints<Real>::upload_springs(const std::vector<PlacedJoint>& joints, const std::vector<bool>& moves) {
  if (loops_.empty() && tree_count() == 0) return;
  std::vector<bool> has_spring(moves.size(), false);
  for (const PlacedJoint& joint : joints)
    if (joint.kind == JointKind::spring)
      for (const std::uint32_t body : {joint.a, joint.b})
        if (body != PlacedJoint::world && moves[body]) has_spring[body] = true;
  std::vector<std::uint32_t> bodies;
  for (std::uint32_t body = 0; body < moves.size(); ++body)
    if (has_spring[body]) bodies.push_back(body);
  if (bodies.empty()) return;
  spring_bodies_.upload(bodies);
  loops_.reserve_corrections(moves.size());
  for (Buffer<PackedVector3<Real>>* sums : {&spring_impulse_, &spring_moment_}) {
    sums->resize_discarding(moves.size());
    sums->fill_zero();
  }
}

/// Uploads the trees. Their joints become indices in rows_.
template <class Real>
void Joints<Real>::upload_trees(const InitialBodies& initial) {
  if (tree_count() == 0) return;
  std::vector<double> sizes(trees_.count(), std::numeric_limits<double>::infinity());
  for (std::size_t tree = 0; tree < trees_.count(); ++tree)
    for (std::uint32_t k = trees_.begin[tree]; k < trees_.begin[tree + 1]; ++k) {
      TreeNode& node = trees_.nodes[k];
      sizes[tree] = std::min(sizes[tree], initial.radius[node.body]);
      if (node.joint != TreeNode::none) node.joint = static_cast<std::uint32_t>(scene_order_[node.joint]);
    }
  nodes_.upload(trees_.nodes);
  tree_begin_.upload(trees_.begin);
  tree_size_.upload(sizes);
  node_states_.resize_discarding(trees_.nodes.size());
  node_states_.fill_zero();
  if (!trees_.closings.empty()) {
    for (TreeClosing& closing : trees_.closings)
      closing.joint = static_cast<std::uint32_t>(scene_order_[closing.joint]);
    closings_.upload(trees_.closings);
    closing_begin_.upload(trees_.closing_begin);
    closing_states_.resize_discarding(trees_.closings.size());
    closing_states_.fill_zero();
    columns_.resize_discarding(trees_.nodes.size());
    columns_.fill_zero();
  }
  members_.upload(std::vector<TreeMember>(initial.size(), TreeMember::none));
}

template <class Real>
JointTreeSolver<Real> Joints<Real>::tree_solver() const {
  JointTreeView<Real> trees{nodes_.data(),    tree_begin_.data(),  tree_size_.data(), rows_.data(),
                            impulses_.data(), node_states_.data(), members_.data(),   tree_count()};
  if (spring_bodies_.size() > 0) {
    trees.correction = loops_.corrections().velocity;
    trees.spin_correction = loops_.corrections().angular_velocity;
  }
  if (closings_.size() > 0) {
    trees.closings = closings_.data();
    trees.closing_begin = closing_begin_.data();
    trees.closing_states = closing_states_.data();
    trees.columns = columns_.data();
  }
  return {{{trees, bodies_, gravity_, h_}}, static_impulses_};
}

template <class Real>
void Joints<Real>::begin_substep(const ImpulsesByBody<Real>& impulses) {
  if (tree_count() > 0)
    executor_.run("joints", tree_count(), BeginTrees<Real>{tree_solver(), impulses, control_});
  loops_.begin(impulses);
  if (spring_bodies_.size() > 0)
    executor_.run("joints", static_cast<std::int64_t>(spring_bodies_.size()),
                  ClearSprings<Real>{spring_bodies_.data(), spring_impulses(), control_});
}

template <class Real>
JointRounds<Real> Joints<Real>::rounds(const BodyView<Real>& bodies) const {
  return {view(), bodies, h_, control_, asleep_, spring_impulses()};
}

template <class Real>
template <class Stage, class StageWithRotation>
void Joints<Real>::run(const BodyView<Real>& bodies) {
  if (colours_ == 0) return;
  bodies_.orientation != nullptr
      ? executor_.run_rounds("joints", colours_, max_joints_per_colour_, StageWithRotation{rounds(bodies)})
      : executor_.run_rounds("joints", colours_, max_joints_per_colour_, Stage{rounds(bodies)});
}

template <class Real>
void Joints<Real>::warm_start() {
  run<WarmStartJoints<Real, false>, WarmStartJoints<Real, true>>(bodies_);
}

template <class Real>
void Joints<Real>::solve() {
  constexpr JointPhase phase = JointPhase::solve;
  run<IterateJoints<Real, false, phase>, IterateJoints<Real, true, phase>>(bodies_);
  if (!loops_.empty()) {
    constexpr JointPhase correct = JointPhase::correct;
    run<IterateJoints<Real, false, correct>, IterateJoints<Real, true, correct>>(loops_.corrections());
  }
  if (tree_count() > 0)
    executor_.run("joints", tree_count(), SolveTrees<Real>{{tree_solver(), control_, asleep_}, false});
}

template <class Real>
void Joints<Real>::end_solve() {
  loops_.add_corrections();
  if (tree_count() > 0)
    executor_.run("joints", tree_count(), SolveTrees<Real>{{tree_solver(), control_, asleep_}, true});
}

template <class Real>
void Joints<Real>::relax(bool first, PackedVector3<Real>* moved) {
  if (first) {
    if (static_impulses_ != nullptr && spring_bodies_.size() > 0) {
      const auto add = [&]<bool with_rotation>() {
        executor_.run_rounds(
            "joints", colours_, max_joints_per_colour_,
            AddSpringPushWork<Real, with_rotation>{rounds(bodies_), loops_.corrections(), static_impulses_});
      };
      bodies_.orientation != nullptr ? add.template operator()<true>() : add.template operator()<false>();
    }
    loops_.remove_corrections();
  }
  constexpr JointPhase phase = JointPhase::relax;
  run<IterateJoints<Real, false, phase>, IterateJoints<Real, true, phase>>(bodies_);
  if (tree_count() > 0)
    executor_.run("joints", tree_count(), RelaxTrees<Real>{{tree_solver(), control_, asleep_}, first, moved});
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
