#include "sim_cuda/run/pipeline.h"

#include "sim_cuda/broad_phase/pair_list.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/dynamics/bounds.h"
#include "sim_cuda/measure/inspect.h"
#include "sim_cuda/measure/measure.h"
#include "sim_cuda/narrow_phase/contact_list.h"
#include "sim_cuda/publish/pack.h"
#include "sim_cuda/run/given_tree.h"
#include "sim_cuda/run/simulation_state.h"
#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/solver/contact_solver.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

namespace {

/// Commits a run: counts it and copies its counts, unless it overflowed. Prepares the sums of hashes.
struct Commit {
  StepControl* control;
  SIM_HD void operator()(int) const {
    control->hash_sums[0] = control->hash_sums[1] = 0;
    if (control->overflow) return;
    ++control->committed;
    control->pairs_committed = control->pairs;
    control->contacts_committed = control->contacts;
    control->uncoloured_committed = control->uncoloured_contacts;
    control->bounce_caps_committed = control->bounce_caps;
    control->bounce_caps = 0;
  }
};

template <class Real>
class TypedPipeline final : public Pipeline {
 public:
  TypedPipeline(Executor& executor, const std::string& broad_phase, const Scene& scene,
                const InitialBodies& initial, Effects effects, int substeps);

  // ---- the stages of a run, in order ----

  void run() override {
    const auto stages = [&] {
      detect(state_.speculative_margin_in(solver_->prediction_time()));
      if (before_writing_ && !executor_.on_device()) before_writing_(*control_.data());
      if (has_given_boxes_) return;  // inspected, not simulated
      // colour, prepare, bounce, forces, solve, move, relax, keep; other solvers have other stages
      solver_->advance(contacts_.view(), impulses_.data());
    };
    validator_ ? validator_->run_validated(guarded(), stages) : stages();
    executor_.run("move", 1, Commit{control_.data()});
    if (records_hashes_) add_hashes("hashes", control_.data()->hash_sums);
  }
  int runs_per_step() const override { return solver_->runs_per_step(); }
  void before_writing(std::function<void(const StepControl&)> callback) override {
    before_writing_ = std::move(callback);
  }

  void detect() override { detect({}); }
  void detect(const SpeculativeMargin<Real>& margin) {
    find_pairs(margin);
    // stage: contacts
    contacts_.find(pairs_.view(), state_.spheres(), margin, excluded_pairs(), control_.data());
  }

  void find_pairs() override { find_pairs({}); }
  void find_pairs(const SpeculativeMargin<Real>& margin) {
    find_bounds(margin);
    // stages: keys, sort, build; other broad phases have other stages
    broad_phase_->update(boxes_.data(), extent());
    // stage: pairs
    pairs_.find(*broad_phase_, control_.data());
  }

  void find_bounds(const SpeculativeMargin<Real>& margin) {
    if (has_given_boxes_) return;
    const BodyBuffers<Real>& bodies = state_.bodies();
    if (margin.bound == MotionBound::none)
      executor_.run("bounds", body_count_,
                    BodyBounds<Real>{bodies.position.data(), bodies.radius.data(), boxes_.data()});
    else
      executor_.run("bounds", body_count_,
                    SweptBounds<Real>{bodies.position.data(),
                                      margin.velocity,
                                      bodies.radius.data(),
                                      boxes_.data(),
                                      {Real(1 + nearly_touching), margin.time, margin.acceleration_margin,
                                       margin.rebound, effects_.continuous_collision}});
  }

  /// Extent of all bodies: the scene's box, or a reduction over the body boxes.
  const Aabb* extent() {
    if (state_.box() || has_given_boxes_ || body_count_ == 0) return extent_.data();
    return reduce<Aabb>(executor_, "bounds", body_count_, LoadBox{boxes_.data()}, extent_.data());
  }

  // ---- set-up and access ----

  void reserve(Capacity capacity) override {
    if (has_given_boxes_) capacity.contacts = 0;  // boxes have none
    pairs_.reserve(body_count_, capacity.pairs);
    broad_phase_->reserve_pairs(capacity.pairs);
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

  std::optional<FirstViolation> first_violation() const override {
    if (!validator_) return std::nullopt;
    const FirstViolation found = validator_->first_violation();
    return found.key == FirstViolation::none ? std::nullopt : std::optional(found);
  }
  void clear_violation() override {
    if (validator_) validator_->clear();
  }
  Finding describe_violation(const FirstViolation& found, int runs_before) override {
    for (int before = 0; before < runs_before; ++before) run();
    validator_->describe(found);
    run();
    return validator_->finding();
  }
  void disable_guards() override { validator_.reset(); }

  void save_warm_start(WarmStartParts& parts) override { solver_->save_warm_start(parts); }
  void load_warm_start(const WarmStart& warm_start) override { solver_->load_warm_start(warm_start); }

  StepControl control() override {  // no allocation, so it works after an out-of-memory error
    StepControl now;
    executor_.copy_to_host(&now, control_.data(), sizeof now);
    return now;
  }
  void clear_overflow() override { executor_.fill(&control_.data()->overflow, 0, sizeof(std::uint32_t)); }
  void set_counts(const StepControl& from) override {
    StepControl now = control();
    now.pairs_committed = from.pairs_committed;
    now.contacts_committed = from.contacts_committed;
    now.uncoloured_committed = from.uncoloured_committed;
    now.bounce_caps_committed = from.bounce_caps_committed;
    executor_.copy_to_executor(control_.data(), &now, sizeof now);
  }
  void visit_persistent_arrays(const ArrayVisitor& visit) override {
    visit(control_.data(), control_.bytes());
    const BodyBuffers<Real>& bodies = state_.bodies();
    visit(bodies.position.data(), bodies.position.bytes());
    visit(bodies.velocity.data(), bodies.velocity.bytes());
    visit(bodies.orientation.data(), bodies.orientation.bytes());
    visit(bodies.angular_velocity.data(), bodies.angular_velocity.bytes());
    visit(bodies.angular_velocity_low.data(), bodies.angular_velocity_low.bytes());
    visit(bodies.static_impulses.data(), bodies.static_impulses.bytes());
    solver_->visit_warm_start(visit);
  }
  BroadPhase& broad_phase() override { return *broad_phase_; }
  BroadPhase& tree_source() override { return given_tree_ ? *given_tree_ : *broad_phase_; }
  std::int64_t broad_phase_bytes() const override { return broad_phase_bytes_; }

  void measure(StepStats& stats) override {
    measurer_.measure(
        {state_.view(), body_count_, state_.bodies().static_impulses.data(), state_.planes(),
         state_.plane_count(), state_.boxes(), state_.gravity().template cast<double>(), state_.attractors(),
         state_.box(), contacts_.view(), control_.data(), contacts_.capacity(), impulses_.view()},
        stats);
    if (joints_) add(joints_->measure(), joints_->count(), stats);
    if (const Sleeping<Real>* sleeping = solver_->sleeping()) add(sleeping->measure(), stats);
  }
  std::uint64_t state_hash() override {
    return hash_sums([&](std::uint64_t* sums) {
             measurer_.add_hashes("hash", state_.view(), body_count_, nullptr, {}, sums);
           })
        .bodies;
  }
  void record_hashes(bool on) override { records_hashes_ = on; }
  StateHashes hashes() override {
    return hash_sums([&](std::uint64_t* sums) { add_hashes("hash", sums); });
  }
  void save_bodies(DeferredParts<BodyStates>& parts) override { state_.download(parts); }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs() override;
  void publish(const PublishTarget& target, const TreeView& tree, const TreeValues& values,
               const float* errors) override {
    pack<Real>(executor_, target,
               {state_.view(), body_count_, state_.meshes(), contacts_.view(), contact_count(),
                impulses_.view(), tree, values, joints_ ? joints_->view() : JointView<Real>{},
                state_.gravity(), solver_->sleeping() ? solver_->sleeping()->view() : SleepView{}, errors},
               publish_counts_);
  }
  std::vector<StaticImpulse> static_impulses() override { return state_.bodies().static_impulses.download(); }
  void set_bodies(const BodyStates& states, const std::vector<StaticImpulse>& static_impulses) override {
    state_.upload(states, static_impulses);
  }
  BodyReport inspect(std::uint32_t id, const TreeView& tree) override {
    return collidoscope::inspect<Real>(executor_,
                                       {state_.view(), body_count_, state_.gravity().template cast<double>(),
                                        contacts_.view(), contact_count(), impulses_.view(), tree},
                                       id);
  }

 private:
  void add_hashes(const char* stage, std::uint64_t* sums) {
    HashedArrays others;
    const Buffer<StaticImpulse>& impulses = state_.bodies().static_impulses;
    if (impulses.size() > 0) others.add<double>(impulses.data(), static_cast<std::int64_t>(impulses.size()));
    solver_->list_warm_start(others);
    measurer_.add_hashes(stage, state_.view(), body_count_, state_.bodies().angular_velocity_low.data(),
                         others, sums);
  }
  template <class Add>
  StateHashes hash_sums(const Add& add) {
    std::uint64_t* const sums = control_.data()->hash_sums;
    executor_.fill(sums, 0, sizeof(StepControl::hash_sums));
    add(sums);
    return StateHashes::of(control().hash_sums);
  }

  ItemCount contact_count() const { return ItemCount(&control_.data()->contacts, contacts_.capacity()); }
  ExcludedPairs excluded_pairs() const { return joints_ ? joints_->excluded_pairs() : ExcludedPairs{}; }
  ValidationSource<Real> guarded() const {
    return {state_.view(),    body_count_,          boxes_.data(),  state_.field(),
            contacts_.view(), contacts_.capacity(), control_.data()};
  }

  Executor& executor_;
  const Effects effects_;
  SimulationState<Real> state_;
  const std::int64_t body_count_;
  Buffer<Aabb> boxes_, extent_;  // extent_: the scene's box, or scratch for the reduction
  const bool has_given_boxes_;
  std::unique_ptr<BroadPhase> broad_phase_;
  std::unique_ptr<BroadPhase> given_tree_;  ///< null: there is none
  std::int64_t broad_phase_bytes_ = 0;
  PairList pairs_;
  ContactList<Real> contacts_;
  std::unique_ptr<Joints<Real>> joints_;  // null if the effect is off
  std::unique_ptr<ContactSolver<Real>> solver_;
  ContactImpulses<Real> impulses_;
  Buffer<StepControl> control_;
  std::unique_ptr<StageValidator<Real>> validator_;  // null if the effect is off
  std::function<void(const StepControl&)> before_writing_;
  Measurer<Real> measurer_;
  bool records_hashes_ = false;
  Buffer<std::uint32_t> publish_counts_;
};

template <class Real>
TypedPipeline<Real>::TypedPipeline(Executor& executor, const std::string& broad_phase, const Scene& scene,
                                   const InitialBodies& initial, Effects effects, int substeps)
    : executor_(executor),
      effects_(effects),
      state_(executor, scene, initial, effects, substeps),
      body_count_(state_.body_count()),
      boxes_(executor, "boxes"),
      extent_(executor, "extent"),
      has_given_boxes_(!initial.boxes.empty()),
      broad_phase_(make_broad_phase(broad_phase, executor)),
      pairs_(executor),
      contacts_(executor),
      impulses_(executor),
      control_(executor, "step control"),
      measurer_(executor),
      publish_counts_(executor, "drawn contacts per body") {
  control_.upload({StepControl{}});
  if (effects.joints)
    joints_ = std::make_unique<Joints<Real>>(
        executor, place_joints(scene, initial), initial, state_.view(),
        effects.gravity ? Vector3<Real>(scene.physics.gravity.cast<Real>())
                        : Vector3<Real>(Vector3<Real>::Zero()),
        state_.static_impulses(), static_cast<Real>(scene.physics.time_step) / static_cast<Real>(substeps),
        control_.data());
  solver_ = make_contact_solver<Real>(scene.physics.solver, executor,
                                      state_.solver_scene(scene, substeps, control_.data(), joints_.get()));
  if (effects.guards)
    validator_ =
        std::make_unique<StageValidator<Real>>(executor, scene.physics.guards.value_or(ValidationSettings{}));

  if (!has_given_boxes_) boxes_.resize_discarding(initial.size());
  if (has_given_boxes_) {
    boxes_.upload(initial.boxes);
    Aabb all = Aabb::empty();
    for (const Aabb& box : initial.boxes) all = combine(all, box);
    extent_.upload({all});
  } else if (const std::optional<Box>& box = state_.box()) {
    extent_.upload({Aabb{box->min.cast<float>(), box->max.cast<float>()}});
  } else {
    extent_.resize_discarding(reduce_scratch_size(body_count_));
  }
  if (initial.tree) given_tree_ = make_given_tree(executor, initial.tree);
  const std::int64_t before = executor.allocated_bytes();
  broad_phase_->reserve(body_count_);
  broad_phase_bytes_ = executor.allocated_bytes() - before;
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

}  // namespace

BodyStates Pipeline::bodies() {
  DeferredParts<BodyStates> parts;
  save_bodies(parts);
  BodyStates states;
  parts.complete(states);
  return states;
}

std::unique_ptr<Pipeline> make_pipeline(Executor& executor, const std::string& broad_phase,
                                        const Scene& scene, const InitialBodies& bodies, Effects effects,
                                        int substeps) {
  effects.joints &= !scene.joints.empty();
  if (scene.physics.precision == Precision::f64)
    return std::make_unique<TypedPipeline<double>>(executor, broad_phase, scene, bodies, effects, substeps);
  return std::make_unique<TypedPipeline<float>>(executor, broad_phase, scene, bodies, effects, substeps);
}

}  // namespace collidoscope
