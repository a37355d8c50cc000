#include "sim_cuda/run/pipeline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_cuda/broad_phase/pair_list.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/dynamics/bounds.h"
#include "sim_cuda/measure/inspect.h"
#include "sim_cuda/measure/measure.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/publish/pack.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

namespace {

/// The run is in the state: count it, and keep what it found.
struct Commit {
  StepControl* control;
  SIM_HD void operator()(int) const {
    if (control->overflow) return;
    ++control->committed;
    control->pairs_committed = control->pairs;
    control->contacts_committed = control->contacts;
    control->split_committed = control->split_contacts;
  }
};

template <class Real>
class TypedPipeline final : public Pipeline {
 public:
  TypedPipeline(Executor& executor, const std::string& broad_phase, const Scene& scene,
                const InitialBodies& initial, Effects effects, int substeps);

  int runs_per_step() const override { return solver_->runs_per_step(); }

  void run() override {
    const auto stages = [&] {
      detect(foresight());
      if (before_writing_ && !executor_.on_device()) before_writing_(*control_.data());
      solver_->advance(contacts_.view(), impulses_.data());
    };
    guard_ ? guard_->watch(guarded(), stages) : stages();
    executor_.run("move", 1, Commit{control_.data()});
  }

  void before_writing(std::function<void(const StepControl&)> told) override {
    before_writing_ = std::move(told);
  }

  void find_pairs() override { find_pairs({}); }
  void detect() override { detect({}); }

  void reserve(Capacity capacity) override {
    pairs_.reserve(body_count_, capacity.pairs);
    contacts_.reserve(body_count_, capacity.contacts);
    solver_->reserve(capacity.contacts);
    measurer_.reserve(body_count_, capacity.contacts);
    impulses_.reserve(capacity.contacts);
  }
  Capacity capacity() const override { return {pairs_.capacity(), contacts_.capacity()}; }

  std::int64_t joints() const override { return joints_ ? joints_->count() : 0; }

  void record_impulses(bool on) override { impulses_.enable(on); }
  void keep_impulses() override { impulses_.keep(contacts_.view().bodies, control_.data()); }
  std::vector<ContactImpulse> impulses() override;

  void record_residuals(bool on) override { solver_->record_residuals(on); }
  std::vector<Residual> residuals() override { return solver_->residuals(); }

  std::optional<FirstFound> found() const override {
    if (!guard_) return std::nullopt;
    const FirstFound found = guard_->found();
    return found.key == FirstFound::none ? std::nullopt : std::optional(found);
  }
  void forget_found() override {
    if (guard_) guard_->forget();
  }
  Finding read_found(const FirstFound& found, int runs_before) override {
    for (int before = 0; before < runs_before; ++before) run();
    guard_->read(found);
    run();
    return guard_->finding();
  }
  void dismiss_guards() override { guard_.reset(); }

  SolverMemory memory() override { return solver_->memory(); }
  void remember(const SolverMemory& memory) override { solver_->remember(memory); }

  StepControl control() override {  // without memory of its own: what a step has done is known in any case
    StepControl now;
    executor_.copy_to_host(&now, control_.data(), sizeof now);
    return now;
  }
  void clear_overflow() override { executor_.fill(&control_.data()->overflow, 0, sizeof(std::uint32_t)); }
  void set_counts(const StepControl& from) override {
    StepControl now = control();
    now.pairs_committed = from.pairs_committed;
    now.contacts_committed = from.contacts_committed;
    now.split_committed = from.split_committed;
    executor_.copy_to_executor(control_.data(), &now, sizeof now);
  }
  void visit_lasting(const ArrayVisit& visit) override {
    visit(control_.data(), control_.bytes());
    visit(state_.position.data(), state_.position.bytes());
    visit(state_.velocity.data(), state_.velocity.bytes());
    visit(state_.orientation.data(), state_.orientation.bytes());
    visit(state_.angular_velocity.data(), state_.angular_velocity.bytes());
    visit(state_.ledger.data(), state_.ledger.bytes());
    solver_->visit_memory(visit);
  }
  BroadPhase& broad_phase() override { return *broad_phase_; }
  std::int64_t broad_phase_bytes() const override { return broad_phase_bytes_; }

  void measure(StepStats& stats) override {
    measurer_.measure({state_.view(), body_count_, state_.ledger.data(), planes_.data(), plane_count_,
                       boxes(), gravity_.template cast<double>(), pulls(), box_, contacts_.view(),
                       control_.data(), contacts_.capacity(), impulses_.view()},
                      stats);
    if (joints_) add(joints_->measure(), joints_->count(), stats);
    if (const Sleeping<Real>* sleeping = solver_->sleeping()) add(sleeping->measure(), stats);
  }
  std::uint64_t state_hash() override { return measurer_.state_hash(state_.view(), body_count_); }
  BodyStates bodies() override;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs() override;
  void publish(const PublishTarget& target, const TreeView& tree, const TreeValues& values,
               const float* errors) override {
    pack<Real>(executor_, target,
               {state_.view(), body_count_, mesh_.data(), contacts_.view(), contact_count(), impulses_.view(),
                tree, values, joints_ ? joints_->view() : JointView<Real>{}, gravity_,
                solver_->sleeping() ? solver_->sleeping()->view() : SleepView{}, errors},
               publish_counts_);
  }
  std::vector<WallLedger> ledgers() override { return state_.ledger.download(); }
  void set_bodies(const BodyStates& states, const std::vector<WallLedger>& ledgers) override;
  BodyReport inspect(std::uint32_t id, const TreeView& tree) override {
    return collidoscope::inspect<Real>(executor_,
                                       {state_.view(), body_count_, gravity_.template cast<double>(),
                                        contacts_.view(), contact_count(), impulses_.view(), tree},
                                       id);
  }

 private:
  Count contact_count() const { return Count(&control_.data()->contacts, contacts_.capacity()); }
  PullView<Real> pulls() const { return {attractors_.data(), static_cast<int>(attractors_.size())}; }
  PartedPairs parted() const { return joints_ ? joints_->parted() : PartedPairs{}; }
  BoxView<Real> boxes() const { return {box_surfaces_.data(), static_cast<int>(box_surfaces_.size())}; }
  SphereView<Real> spheres() const {
    return {state_.position.data(), state_.radius.data(),
            prescribed_.size() > 0 ? state_.inverse_mass.data() : nullptr};
  }
  GuardedView<Real> guarded() const {
    return {state_.view(),    body_count_,          boxes_.data(),  field_.data(),
            contacts_.view(), contacts_.capacity(), control_.data()};
  }
  Foresight<Real> foresight() const {
    const Real time = solver_->foresight();
    if (!(time > 0)) return {};
    const Course course = effects_.continuous_collision ? Course::any
                          : effects_.drag               ? Course::dragged
                                                        : Course::straight;
    return {course, state_.velocity.data(), time, slack_in(time)};
  }
  /// m: what gravity and attractors add to the way of two bodies to each other in `time`.
  Real slack_in(Real time) const {
    using std::sqrt;
    return time * time * (sqrt(gravity_.dot(gravity_)) + 2 * largest_pull_);
  }
  void find_pairs(const Foresight<Real>& foresight);
  void detect(const Foresight<Real>& foresight) {
    find_pairs(foresight);
    contacts_.find(pairs_.view(), spheres(), foresight, parted(), control_.data());
  }

  Executor& executor_;
  const std::int64_t body_count_;
  const Effects effects_;
  const std::optional<Box> box_;
  Vector3<Real> gravity_;                  // m/s^2, zero where the effect is off
  Buffer<PullingPoint<Real>> attractors_;  // empty where the effect is off, as
  Buffer<Vector3<Real>> field_;            // their pull on each body, m/s^2
  Real largest_pull_ = 0;                  // m/s^2, of all attractors together
  BodyBuffers<Real> state_;
  Buffer<std::uint32_t> prescribed_;  // ids of bodies that no force moves
  Buffer<std::uint32_t> mesh_;        // 0: sphere; empty where all are
  Buffer<Real> restitution_of_material_;
  Buffer<Real> friction_of_material_;                    // empty where the effect is off
  Buffer<Real> rolling_of_material_, rolling_of_plane_;  // as well
  Buffer<WallPlane<Real>> planes_;
  Buffer<BoxSurface<Real>> box_surfaces_;
  int plane_count_ = 0;
  Restitution<Real> restitution_;
  Buffer<Aabb> boxes_, extent_;  // extent: the box, or scratch for the extent of all boxes
  std::unique_ptr<BroadPhase> broad_phase_;
  std::int64_t broad_phase_bytes_ = 0;
  PairList pairs_;
  ContactList<Real> contacts_;
  std::unique_ptr<Joints<Real>> joints_;  // null where the effect is off
  std::unique_ptr<ContactSolver<Real>> solver_;
  ContactImpulses<Real> impulses_;
  Buffer<StepControl> control_;
  std::unique_ptr<StageGuard<Real>> guard_;  // null where the effect is off
  std::function<void(const StepControl&)> before_writing_;
  Measurer<Real> measurer_;
  Buffer<std::uint32_t> publish_counts_;
};

template <class Real>
std::vector<Vector3<Real>> narrowed(const std::vector<Vector3d>& wide) {
  std::vector<Vector3<Real>> narrow(wide.size());
  for (std::size_t i = 0; i < wide.size(); ++i) narrow[i] = wide[i].cast<Real>();
  return narrow;
}
template <class Real>
std::vector<StoredVector3<Real>> stored(const std::vector<Vector3d>& wide) {
  const std::vector<Vector3<Real>> narrow = narrowed<Real>(wide);
  return {narrow.begin(), narrow.end()};
}

template <class Real>
std::vector<BoxSurface<Real>> box_surfaces(const Scene& scene) {
  std::vector<BoxSurface<Real>> surfaces;
  for (const BoxObstacle& box : scene.boxes) {
    const Material& material = scene.materials[static_cast<std::size_t>(box.material)];
    const Matrix3d turn = box.orientation.toRotationMatrix();
    surfaces.push_back({box.center.cast<Real>(),
                        (box.size / 2).cast<Real>(),
                        {turn.col(0).cast<Real>(), turn.col(1).cast<Real>(), turn.col(2).cast<Real>()},
                        static_cast<Real>(material.restitution),
                        static_cast<Real>(material.friction)});
  }
  return surfaces;
}

template <class Real>
std::vector<WallPlane<Real>> wall_planes(const Scene& scene, const std::optional<Box>& box) {
  std::vector<WallPlane<Real>> planes;
  for (const Plane& p : scene.obstacles)
    planes.push_back({p.normal.cast<Real>(), static_cast<Real>(p.offset),
                      static_cast<Real>(scene.materials[static_cast<std::size_t>(p.material)].restitution),
                      static_cast<Real>(scene.materials[static_cast<std::size_t>(p.material)].friction)});
  if (box) {
    const auto e = static_cast<Real>(scene.materials[0].restitution),
               mu = static_cast<Real>(scene.materials[0].friction);
    for (int axis = 0; axis < 3; ++axis) {
      Vector3<Real> inward(0, 0, 0);
      inward[axis] = 1;
      planes.push_back({inward, static_cast<Real>(box->min[axis]), e, mu});
      planes.push_back({-inward, -static_cast<Real>(box->max[axis]), e, mu});
    }
  }
  return planes;
}

/// The approach speed below which nothing bounces; "auto": twice what gravity adds in a run, so that resting
/// contacts rest.
double bounce_threshold(const Physics& physics, int substeps, bool gravity) {
  if (physics.restitution_threshold) return *physics.restitution_threshold;
  return gravity ? 2 * std::sqrt(physics.gravity.dot(physics.gravity)) * physics.time_step / substeps : 0;
}

template <class Real>
TypedPipeline<Real>::TypedPipeline(Executor& executor, const std::string& broad_phase, const Scene& scene,
                                   const InitialBodies& initial, Effects effects, int substeps)
    : executor_(executor),
      body_count_(static_cast<std::int64_t>(initial.size())),
      effects_(effects),
      box_(initial.box),
      gravity_(effects.gravity ? Vector3<Real>(scene.physics.gravity.cast<Real>()) : Vector3<Real>(0, 0, 0)),
      attractors_(executor, "attractors"),
      field_(executor, "accelerations"),
      state_(executor),
      prescribed_(executor, "bodies that no force moves"),
      mesh_(executor, "meshes of bodies"),
      restitution_of_material_(executor, "restitution by material"),
      friction_of_material_(executor, "friction by material"),
      rolling_of_material_(executor, "rolling resistance by material"),
      rolling_of_plane_(executor, "rolling resistance by plane"),
      planes_(executor, "walls"),
      box_surfaces_(executor, "box obstacles"),
      boxes_(executor, "boxes"),
      extent_(executor, "extent"),
      broad_phase_(make_broad_phase(broad_phase, executor)),
      pairs_(executor),
      contacts_(executor),
      impulses_(executor),
      control_(executor, "step control"),
      measurer_(executor),
      publish_counts_(executor, "contacts per body to draw") {
  const std::size_t n = initial.size();
  executor.heed();
  state_.position.upload(narrowed<Real>(initial.position));
  state_.velocity.upload(initial.velocity.empty()
                             ? std::vector<StoredVector3<Real>>(n, Vector3<Real>(Vector3<Real>::Zero()))
                             : stored<Real>(initial.velocity));
  std::vector<Real> radius(n), mass(n), inverse_mass(n);
  for (std::size_t i = 0; i < n; ++i) {
    radius[i] = static_cast<Real>(initial.radius[i]);
    mass[i] = static_cast<Real>(initial.mass[i]);
    inverse_mass[i] = 1 / mass[i];
  }
  std::vector<std::uint32_t> prescribed;
  for (std::size_t i = 0; i < initial.motion.size(); ++i) {
    if (initial.motion[i] == Motion::dynamic) continue;
    prescribed.push_back(static_cast<std::uint32_t>(i));
    mass[i] = inverse_mass[i] = 0;
  }
  prescribed_.upload(prescribed);
  state_.radius.upload(radius);
  state_.mass.upload(mass);
  state_.inverse_mass.upload(inverse_mass);
  executor.heed();
  if (effects.rotation) {
    std::vector<Quaternion<Real>> orientation(n, Quaternion<Real>(1, 0, 0, 0));
    std::vector<StoredVector3<Real>> spin(n, Vector3<Real>(Vector3<Real>::Zero()));
    std::vector<Vector3<Real>> inertia(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (!initial.orientation.empty()) orientation[i] = initial.orientation[i].template cast<Real>();
      if (!initial.angular_velocity.empty())
        spin[i] = Vector3<Real>(initial.angular_velocity[i].template cast<Real>());
      const double ball = 0.4 * initial.mass[i] * initial.radius[i] * initial.radius[i];
      inertia[i] = initial.inertia.empty() ? Vector3<Real>::Constant(static_cast<Real>(ball))
                                           : Vector3<Real>(initial.inertia[i].template cast<Real>());
    }
    for (const std::uint32_t i : prescribed)
      inertia[i] = Vector3<Real>::Constant(std::numeric_limits<Real>::infinity());
    state_.orientation.upload(orientation);
    state_.angular_velocity.upload(spin);
    state_.inertia.upload(inertia);
  }
  if (scene.materials.size() > 1 && !initial.material.empty()) state_.material.upload(initial.material);
  mesh_.upload(initial.mesh);

  std::vector<Real> restitution;
  for (const Material& m : scene.materials) restitution.push_back(static_cast<Real>(m.restitution));
  restitution_of_material_.upload(restitution);
  restitution_ = {restitution_of_material_.data(), state_.material.data(),
                  static_cast<Real>(bounce_threshold(scene.physics, substeps, effects.gravity))};

  if (effects.friction) {
    std::vector<Real> friction;
    for (const Material& m : scene.materials) friction.push_back(static_cast<Real>(m.friction));
    friction_of_material_.upload(friction);
  }

  if (effects.attractor) {
    std::vector<PullingPoint<Real>> points;
    for (const Attractor& a : scene.physics.attractors) {
      points.push_back(PullingPoint<Real>::of(a));
      largest_pull_ += static_cast<Real>(largest_pull(a));
    }
    attractors_.upload(points);
    field_.resize_discarding(n);
  }

  planes_.upload(wall_planes<Real>(scene, box_));
  plane_count_ = static_cast<int>(planes_.size());
  if (effects.rolling_resistance) {
    const auto of = [&](int material) {
      return static_cast<Real>(scene.materials[static_cast<std::size_t>(material)].rolling_resistance);
    };
    std::vector<Real> by_material, by_plane;
    for (int k = 0; k < static_cast<int>(scene.materials.size()); ++k) by_material.push_back(of(k));
    for (const Plane& plane : scene.obstacles) by_plane.push_back(of(plane.material));
    by_plane.resize(planes_.size(), of(0));  // the box
    for (const BoxObstacle& box : scene.boxes) by_plane.push_back(of(box.material));
    rolling_of_material_.upload(by_material);
    rolling_of_plane_.upload(by_plane);
  }
  box_surfaces_.upload(box_surfaces<Real>(scene));
  if (plane_count_ > 0 || !scene.boxes.empty()) state_.ledger.upload(std::vector<WallLedger>(n));

  executor.heed();
  control_.upload({StepControl{}});
  const auto time_step = static_cast<Real>(scene.physics.time_step);
  if (effects.joints)
    joints_ = std::make_unique<Joints<Real>>(executor, place_joints(scene, initial), initial, state_.view(),
                                             time_step / static_cast<Real>(substeps), control_.data());
  solver_ = make_contact_solver<Real>(
      scene.physics.solver, executor,
      {state_.view(),
       body_count_,
       {prescribed_.data(), static_cast<std::int64_t>(prescribed_.size())},
       restitution_,
       {friction_of_material_.data(), state_.material.data()},
       {rolling_of_material_.data(), state_.material.data(), rolling_of_plane_.data()},
       planes_.data(),
       plane_count_,
       boxes(),
       state_.ledger.data(),
       gravity_,
       DragLaw<Real>::of(scene.physics.drag),
       pulls(),
       field_.data(),
       effects,
       box_,
       time_step,
       slack_in(time_step),
       substeps,
       scene.physics.iterations,
       scene.physics.integrator,
       scene.physics.rotation_update,
       scene.physics.sleep.value_or(Sleep{}),
       control_.data(),
       joints_.get()});

  if (effects.guards)
    guard_ = std::make_unique<StageGuard<Real>>(executor, scene.physics.guards.value_or(Guards{}));

  boxes_.resize_discarding(n);
  if (box_)
    extent_.upload({Aabb{box_->min.cast<float>(), box_->max.cast<float>()}});
  else
    extent_.resize_discarding(reduce_scratch_size(body_count_));
  const std::int64_t before = executor.allocated_bytes();
  broad_phase_->reserve(body_count_);
  broad_phase_bytes_ = executor.allocated_bytes() - before;
}

template <class Real>
void TypedPipeline<Real>::find_pairs(const Foresight<Real>& foresight) {
  if (foresight.course == Course::rest)
    executor_.run("bounds", body_count_,
                  BodyBounds<Real>{state_.position.data(), state_.radius.data(), boxes_.data()});
  else
    executor_.run(
        "bounds", body_count_,
        SweptBounds<Real>{state_.position.data(), foresight.velocity, state_.radius.data(), foresight.time,
                          foresight.slack, boxes_.data(), effects_.continuous_collision});
  const Aabb* extent = extent_.data();
  if (!box_ && body_count_ > 0)
    extent = reduce<Aabb>(executor_, "bounds", body_count_, LoadBox{boxes_.data()}, extent_.data());
  broad_phase_->update(boxes_.data(), extent);
  pairs_.find(*broad_phase_, control_.data());
}

template <class Real>
BodyStates TypedPipeline<Real>::bodies() {
  const auto widened = [](const auto& narrow) {
    std::vector<Vector3d> wide(narrow.size());
    for (std::size_t i = 0; i < narrow.size(); ++i)
      wide[i] = Vector3<Real>(narrow[i]).template cast<double>();
    return wide;
  };
  BodyStates states;
  const auto n = static_cast<std::size_t>(body_count_);
  states.position = widened(state_.position.download());
  states.velocity = widened(state_.velocity.download());
  states.angular_velocity.assign(n, Vector3d(0, 0, 0));
  states.orientation.assign(n, Quaterniond(1, 0, 0, 0));
  if (effects_.rotation) {
    states.angular_velocity = widened(state_.angular_velocity.download());
    const auto q = state_.orientation.download();
    for (std::size_t i = 0; i < n; ++i) states.orientation[i] = q[i].template cast<double>();
  }
  return states;
}

template <class Real>
std::vector<std::pair<std::uint32_t, std::uint32_t>> TypedPipeline<Real>::pairs() {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> list;
  if (body_count_ == 0) return list;
  const auto n = static_cast<std::size_t>(body_count_);
  std::vector<std::uint32_t> offset(n + 1);
  std::vector<std::uint32_t> second(control().pairs);
  executor_.copy_to_host(offset.data(), pairs_.view().offset, offset.size() * sizeof offset[0]);
  executor_.copy_to_host(second.data(), pairs_.view().second, second.size() * sizeof second[0]);
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t k = offset[a]; k < offset[a + 1]; ++k) list.emplace_back(a, second[k]);
  return list;
}

template <class Real>
std::vector<ContactImpulse> TypedPipeline<Real>::impulses() {
  std::vector<ContactImpulse> list;
  const ImpulseView<Real> view = impulses_.view();
  if (view.count == nullptr) return list;
  std::uint32_t count = 0;
  executor_.copy_to_host(&count, view.count, sizeof count);
  std::vector<Pair> contacts(count);
  std::vector<Real> impulse(count);
  executor_.copy_to_host(contacts.data(), view.contacts, count * sizeof contacts[0]);
  executor_.copy_to_host(impulse.data(), view.impulse, count * sizeof impulse[0]);
  for (std::uint32_t k = 0; k < count; ++k)
    list.push_back({contacts[k].a, contacts[k].b, static_cast<double>(impulse[k])});
  return list;
}

template <class Real>
void TypedPipeline<Real>::set_bodies(const BodyStates& states, const std::vector<WallLedger>& ledgers) {
  const std::size_t n = states.position.size();
  const auto write = [&](const auto& buffer, const auto& values) {
    executor_.copy_to_executor(buffer.data(), values.data(), n * sizeof values[0]);
  };
  write(state_.position, narrowed<Real>(states.position));
  write(state_.velocity, stored<Real>(states.velocity));
  if (effects_.rotation) {
    std::vector<Quaternion<Real>> orientation(n);
    for (std::size_t i = 0; i < n; ++i) orientation[i] = states.orientation[i].template cast<Real>();
    write(state_.orientation, orientation);
    write(state_.angular_velocity, stored<Real>(states.angular_velocity));
  }
  if (state_.ledger.size() > 0 && ledgers.size() >= n) write(state_.ledger, ledgers);
}

}  // namespace

std::unique_ptr<Pipeline> make_pipeline(Executor& executor, const std::string& broad_phase,
                                        const Scene& scene, const InitialBodies& bodies, Effects effects,
                                        int substeps) {
  effects.joints &= !scene.joints.empty();
  if (scene.physics.precision == Precision::f64)
    return std::make_unique<TypedPipeline<double>>(executor, broad_phase, scene, bodies, effects, substeps);
  return std::make_unique<TypedPipeline<float>>(executor, broad_phase, scene, bodies, effects, substeps);
}

}  // namespace collidoscope
