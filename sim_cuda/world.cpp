#include "sim_cuda/world.h"

#include <algorithm>
#include <utility>

#include "sim_cuda/broad_phase/broad_phase.h"
#include "sim_cuda/broad_phase/current_tree.h"
#include "sim_cuda/broad_phase/key_bits.h"
#include "sim_cuda/broad_phase/methods.h"
#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/run/broad_phase_times.h"
#include "sim_cuda/run/frozen.h"
#include "sim_cuda/run/rewind.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/run/settled_state.h"
#include "sim_cuda/run/step_estimate.h"
#include "sim_cuda/run/step_runner.h"
#include "sim_cuda/run/step_undo.h"
#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/joint_substeps.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

namespace {

RunOptions with_key_bits(RunOptions options, const InitialBodies& bodies, const RunState* start) {
  if (options.key_bits == 0)
    options.key_bits = key_bits_called_for(
        bodies, start != nullptr ? start->bodies.position : bodies.position, options.sort);
  return options;
}

/// How long the lists of a pipeline are at first: about four times what a packing of such spheres shows, so
/// that most scenes never grow.
Capacity first_capacity(const RunOptions& options, const InitialBodies& bodies) {
  const auto usual = std::max<std::int64_t>(1024, 4 * static_cast<std::int64_t>(bodies.size()));
  const std::int64_t guess = options.initial_pair_capacity > 0 ? options.initial_pair_capacity : usual;
  return {guess, guess};
}

}  // namespace

struct World::Impl {
  /// `start`: where it will go on from, as adopt() does it.
  Impl(const Scene& s, const RunOptions& asked, const RunState* start, const BodyIds& ids)
      : scene(valid(s)),
        options(asked),
        initial((expect_room_for_bodies(scene, options), initial_bodies(scene, options.cancellation))),
        executor(with_key_bits(asked, initial, start)),
        effects(scene.physics.effects.value_or(effects_called_for(scene, initial))),
        substeps(substeps_of(scene, initial)),
        undo(executor),
        watched(effects.guards),
        tree(executor, static_cast<std::int64_t>(initial.size())),
        runner(executor,
               (expect_room_for_step(executor, {options.broad_phase, scene, initial, effects, substeps, start,
                                                ids, first_capacity(options, initial)}),
                make()),
               first_capacity(options, initial)) {}

  /// A pipeline that has reserved nothing yet.
  std::unique_ptr<Pipeline> make() {
    auto next = frozen.empty()
                    ? make_pipeline(executor, options.broad_phase, scene, initial, effects, substeps)
                    : make_pipeline(executor, options.broad_phase, scene, with_frozen(initial, frozen),
                                    effects, substeps);
    next->before_writing([this](const StepControl& control) {
      undo.before_writing(runner.pipeline(), control,
                          seconds_to_solve(executor, scene.physics, static_cast<double>(initial.size()),
                                           control.contacts, substeps));
    });
    next->record_impulses(recording);
    next->record_residuals(residuals);
    if (!watched) next->dismiss_guards();
    return next;
  }

  /// After something was cancelled: all as it was before that step.
  void recover();
  Pipeline& pipeline() {
    recover();
    return runner.pipeline();
  }
  const Pipeline& pipeline() const { return runner.pipeline(); }

  /// These bodies are what no force moves, until others are. Where memory is lacking, nothing has changed.
  void set_frozen(const std::vector<std::uint32_t>& bodies) {
    if (bodies == frozen) return;
    runner.forget_recorded();
    const std::vector<std::uint32_t> before = std::exchange(frozen, bodies);
    try {
      auto next = make();
      next->reserve(pipeline().capacity());
      runner.replace(std::move(next));
    } catch (...) {
      frozen = before;
      throw;
    }
  }

  /// The pipeline, which has no such, goes on from there.
  void put(const RunState& state) {
    runner.pipeline().set_bodies(state.bodies, state.ledgers);
    runner.pipeline().remember(state.memory);
    steps = state.steps;
    // Where all steps were of this length, their number alone says it, without a sum's rounding.
    const bool one_length = state.time == static_cast<double>(state.steps) * scene.physics.time_step;
    known_time = one_length ? KnownTime{} : KnownTime{state.steps, state.time};
    detected = residuals_known = false;
  }

  double time() const {
    return known_time.time + static_cast<double>(steps - known_time.step) * scene.physics.time_step;
  }

  /// Does one step; or what guards found in it, which then is neither in `steps` nor in a state of any use.
  std::optional<FirstFound> advance();

  void keep_impulses() {
    if (impulses_new) pipeline().keep_impulses();
    impulses_new = false;
  }

  /// Of the boxes of the last step or detect(); arranged when somebody asks.
  const TreeView& arranged_tree() { return tree.arranged(pipeline().broad_phase()); }

  World* owner = nullptr;
  Scene scene;
  RunOptions options;  // as asked for
  InitialBodies initial;
  Executor executor;  // before everything that lives on it
  Effects effects;
  int substeps;  // as the pipeline takes them
  StepUndo undo;
  std::optional<std::int64_t> return_to;  // the state that resolve() was cancelled at
  std::int64_t steps = 0;
  struct KnownTime {
    std::int64_t step = 0;
    double time = 0;    // s
  } known_time;         // of a state from which on all steps are of the same length
  bool watched;         // guards look
  bool paused = false;  // at `finding`
  std::optional<Finding> finding;
  std::vector<std::uint32_t> frozen;
  Rewind rewind;
  CurrentTree tree;
  bool detected = false;         // pairs and contacts are those of the current state
  bool stepped = false;          // a step led to the current state, in this world
  bool recording = false;        // steps note the impulses of contacts
  bool residuals = false;        // steps measure what sweeps leave
  bool residuals_known = false;  // the last one did
  bool impulses_new = false;     // they belong to the contacts in the list, and are not kept yet
  std::vector<std::unique_ptr<Buffer<std::byte>>> scratch;
  std::vector<float> errors;                    // of bodies, m
  std::unique_ptr<Buffer<float>> drawn_errors;  // made when they are first drawn
  StepRunner runner;
};

World::World(const Scene& scene, const RunOptions& options, const RunState* start, const BodyIds& ids) {
  while_doing("making a world", [&] {
    std::optional<RunState> rest;
    if (start == nullptr && settles(valid(scene))) start = &rest.emplace(settled_state(scene, options));
    impl_ = std::make_unique<Impl>(scene, options, start, ids);
    impl_->owner = this;
    if (start != nullptr) adopt(*start, ids);
  });
}
World::~World() = default;
World::World(World&& other) noexcept : impl_(std::move(other.impl_)) {
  if (impl_) impl_->owner = this;
}
World& World::operator=(World&& other) noexcept {
  impl_ = std::move(other.impl_);
  if (impl_) impl_->owner = this;
  return *this;
}

const Scene& World::scene() const { return impl_->scene; }
const InitialBodies& World::initial() const { return impl_->initial; }
const RunOptions& World::options() const { return impl_->options; }
int World::key_bits() const {
  return has_morton_keys(impl_->options.broad_phase) ? impl_->executor.options().key_bits : 0;
}
Effects World::effects() const { return impl_->effects; }
int World::substeps() const { return impl_->substeps; }
bool World::on_gpu() const { return impl_->executor.on_device(); }
int World::gpu() const { return impl_->executor.gpu(); }
std::string World::device_name() const { return impl_->executor.device_name(); }
std::int64_t World::allocated_bytes() const { return impl_->executor.allocated_bytes(); }
std::map<std::string, std::int64_t> World::buffers() const { return impl_->executor.bytes_by_name(); }
LaunchShape World::launch_shape() const { return impl_->options.shape; }
std::int64_t World::steps() const { return impl_->steps; }
double World::time() const { return impl_->time(); }

void World::step(int count) {
  Impl& w = *impl_;
  for (int done = 0; done < count && !w.paused;) {
    w.recover();
    if (w.watched) w.rewind.before_step(*this);
    const std::uint32_t first_run = w.runner.committed();
    if (const std::optional<FirstFound> found = w.advance())
      resolve(*found, first_run);
    else
      ++done;
  }
}

std::optional<FirstFound> World::Impl::advance() {
  const bool with_events = steps % 2 == 1;
  detected = false;
  struct AtItsEnd {  // even where the clock then finds no memory to note its time in
    Impl& world;
    std::uint32_t target;
    bool found = false;
    ~AtItsEnd() {
      if (found || world.runner.committed() != target) return;
      ++world.steps;
      world.stepped = true;
      world.impulses_new = world.recording;
      world.residuals_known = world.residuals;
    }
  } count_it{*this, runner.next()};
  undo.begin_step(runner.pipeline().runs_per_step());
  try {
    const std::optional<FirstFound> found =
        while_doing("making a step", [&] { return runner.step(with_events); });
    count_it.found = found.has_value();
    undo.end_step();
    return found;
  } catch (const Cancelled&) {
    undo.leave_step();
    throw;
  } catch (...) {
    undo.end_step();
    throw;
  }
}

void World::Impl::recover() {
  if (!executor.interrupted()) return;
  if (executor.on_device() || options.cancellation->requested()) throw Cancelled();
  const Executor::Uninterrupted whole(executor);
  executor.resume();
  undo.undo();
  const StepControl counts = runner.pipeline().control();
  const RunState state = owner->state();
  runner.remake([this] { return make(); });
  put(state);
  runner.pipeline().set_counts(counts);
  impulses_new = false;
  tree.forget();
  if (!return_to) return;
  const std::optional<Finding> known = finding;
  rewind.to(*owner, *std::exchange(return_to, std::nullopt));
  finding = known;
}

/// Back to the state before the step, which is done up to there once more to read what was found; then
/// freezes its body, or pauses.
void World::resolve(const FirstFound& found, std::uint32_t first_run) {
  Impl& w = *impl_;
  const Guards guards = w.scene.physics.guards.value_or(Guards{});
  const int run = static_cast<int>(found.run - first_run);
  const std::int64_t at = w.steps;
  const std::optional<Finding> known = w.finding;
  RunState before;
  Finding finding;
  try {
    w.runner.forget_runs();
    w.rewind.to(*this, at);
    before = state();
    finding = w.pipeline().read_found(found, run);
  } catch (const Cancelled&) {
    w.return_to = at;
    w.finding = known;
    throw;
  }
  w.runner.forget_runs();
  finding.step = before.steps + 1;
  finding.substep += run;
  finding.before = !is_sane(before.bodies, finding.body, guards);
  const InitialBodies now = with_frozen(w.initial, w.frozen);
  const bool moves = now.motion.empty() || now.motion[finding.body] == Motion::dynamic;
  const bool freezes = guards.on_failure == OnFailure::freeze && moves;
  if (freezes) freeze(before, finding.body, w.initial, guards);
  adopt(before);
  w.finding = finding;
  w.paused = !freezes;
}

const std::optional<Finding>& World::finding() const { return impl_->finding; }
bool World::paused() const { return impl_->paused; }
const std::vector<std::uint32_t>& World::frozen() const { return impl_->frozen; }

void World::dismiss() {
  Impl& w = *impl_;
  w.runner.forget_recorded();
  w.pipeline().dismiss_guards();
  w.rewind.forget();
  w.finding.reset();
  w.watched = w.paused = false;
}

void World::record_impulses(bool on) {
  Impl& w = *impl_;
  if (on == w.recording) return;
  w.runner.forget_recorded();
  w.pipeline().record_impulses(on);
  w.recording = on;
  w.impulses_new = false;
}

std::vector<ContactImpulse> World::impulses() {
  impl_->keep_impulses();
  return impl_->pipeline().impulses();
}

void World::record_residuals(bool on) {
  Impl& w = *impl_;
  if (on == w.residuals) return;
  w.runner.forget_recorded();
  w.pipeline().record_residuals(on);
  w.residuals = on;
  w.residuals_known = false;
}

std::vector<Residual> World::residuals() {
  return impl_->residuals_known ? impl_->pipeline().residuals() : std::vector<Residual>{};
}

void World::set_launch_shape(LaunchShape shape) {
  Impl& w = *impl_;
  w.executor.set_shape(shape);
  w.options.shape = shape;
  w.runner.forget_recorded();  // a recorded step has the old shape in it
}

namespace {

/// Of all settings, but not of which bodies there are; 0 where nothing can sleep.
std::uint64_t settings_hash(Scene scene) {
  if (!scene.physics.sleep) return 0;
  leave_out_guards(scene.physics);  // they decide nothing
  scene.bodies.clear();
  scene.added.clear();
  scene.joints.clear();
  for (BoxCollider& generator : scene.generators) {
    generator.count = 0;
    generator.without.clear();
  }
  std::uint64_t hash = 0;
  for (const char letter : write_scene(scene)) hash = mix64(hash ^ static_cast<unsigned char>(letter));
  return hash;
}

}  // namespace

RunState World::state() {
  Impl& w = *impl_;
  return {w.steps,
          w.pipeline().bodies(),
          w.pipeline().ledgers(),
          w.pipeline().memory(),
          settings_hash(w.scene),
          w.frozen,
          w.time()};
}

void World::adopt(World& other) { adopt(other.state()); }

void World::adopt(const RunState& other, const BodyIds& ids) {
  Impl& w = *impl_;
  w.recover();
  const Executor::Uninterrupted whole(w.executor);
  RunState state = renumbered(other, ids, w.pipeline().bodies());
  w.runner.forget_recorded();  // what the solver remembers may move
  w.set_frozen(state.frozen);
  for (const std::uint32_t body : state.frozen) {
    state.bodies.velocity[body].setZero();
    state.bodies.angular_velocity[body].setZero();
  }
  if (other.settings != settings_hash(w.scene)) state.memory.slow.clear();
  w.put(state);
  w.stepped = false;
  w.paused = false;
  w.finding.reset();
  w.rewind.forget();
}

BodyReport World::inspect(std::uint32_t id) {
  if (id >= impl_->initial.size()) throw std::out_of_range("inspect: there is no body " + std::to_string(id));
  detect();
  return impl_->pipeline().inspect(id, impl_->arranged_tree());
}

namespace {

/// Of the stages of a step alone, with the launches of all its runs.
RunTimes of_step(RunTimes times, int runs) {
  std::erase_if(times.stages, [](const StageTime& s) {
    return s.name == "measure" || s.name == "hash" || s.name == "publish" || s.name == "inspect" ||
           s.name == "tree" || s.name == "quality";
  });
  for (StageTime& s : times.stages) s.launches *= runs;
  return times;
}

}  // namespace

RunTimes World::times() const {
  return of_step(impl_->executor.clock().times(), impl_->pipeline().runs_per_step());
}

RunTimes World::latest_times() const {
  return of_step(impl_->executor.clock().latest(), impl_->pipeline().runs_per_step());
}

void World::detect() {
  Impl& w = *impl_;
  w.recover();
  if (w.detected) return w.runner.expect_memory();
  w.keep_impulses();
  while_doing("finding pairs", [&] { w.runner.detect(); });
  w.detected = true;
  w.tree.forget();
}

StepStats World::measure() {
  Impl& w = *impl_;
  detect();  // from here on the lists are those of the current state, without a margin
  const StepControl now = w.pipeline().control();
  const bool stepped = w.stepped;  // else no step of this world has counted them
  StepStats stats;
  stats.step = w.steps;
  stats.bodies = static_cast<std::int64_t>(w.initial.size());
  stats.pairs = stepped ? now.pairs_committed : now.pairs;
  stats.touching = now.contacts;
  stats.speculative = stepped ? now.contacts_committed : now.contacts;
  stats.split_contacts = stepped ? now.split_committed : 0;
  w.pipeline().measure(stats);
  return stats;
}

std::uint64_t World::state_hash() { return impl_->pipeline().state_hash(); }
BodyStates World::bodies() { return impl_->pipeline().bodies(); }
std::vector<std::pair<std::uint32_t, std::uint32_t>> World::pairs() { return impl_->pipeline().pairs(); }

std::int64_t World::tree_nodes() const { return impl_->pipeline().broad_phase().tree_nodes(); }

std::vector<std::int64_t> World::tree_level_sizes() {
  detect();
  const TreeView& tree = impl_->arranged_tree();
  std::vector<std::int64_t> sizes;
  for (int level = 0; level < tree.levels(); ++level) sizes.push_back(tree.level_size(level));
  return sizes;
}

TreeLevels World::tree_levels() {
  detect();
  const TreeView& tree = impl_->arranged_tree();
  TreeLevels levels;
  for (int level = 0; level < tree.levels(); ++level) {
    static_assert(sizeof(TreeLevels::Box) == sizeof(Aabb));
    std::vector<TreeLevels::Box> boxes(tree.level_size(level));
    impl_->executor.copy_to_host(boxes.data(), tree.box + tree.level_begin(level),
                                 boxes.size() * sizeof(Aabb));
    levels.levels.push_back(std::move(boxes));
  }
  return levels;
}

const TreeQuality& World::tree_quality() {
  detect();
  Pipeline& pipeline = impl_->pipeline();
  return impl_->tree.quality(pipeline.broad_phase(), pipeline.broad_phase_bytes());
}

std::vector<NodeReport> World::ranked_nodes(NodeMetric metric, std::int64_t first, std::int64_t count,
                                            int from, int to) {
  tree_quality();
  return impl_->tree.meter().ranked(impl_->arranged_tree(), metric, first, count, from, to);
}

std::vector<NodeReport> World::tree_nodes_at(const std::vector<std::uint32_t>& places) {
  tree_quality();
  for (const std::uint32_t place : places)
    if (place >= tree_nodes())
      throw std::out_of_range("tree_node: there is no node " + std::to_string(place));
  return impl_->tree.meter().nodes(impl_->arranged_tree(), places);
}

NodeReport World::tree_node(std::uint32_t place) { return tree_nodes_at({place}).front(); }

NodeSpread World::node_spread(NodeMetric metric, const NodeSelection& selection) {
  tree_quality();
  return impl_->tree.meter().spread(impl_->arranged_tree(), metric, selection);
}

const std::vector<std::int64_t>& World::tree_leaves() {
  detect();
  return impl_->tree.leaves(impl_->pipeline().broad_phase());
}

std::vector<std::uint32_t> World::visited_nodes(std::uint32_t id, std::int64_t most) {
  tree_quality();
  if (id >= impl_->initial.size())
    throw std::out_of_range("visited_nodes: there is no body " + std::to_string(id));
  return impl_->tree.meter().visited(impl_->arranged_tree(), id, most);
}

double World::own_visits() {
  detect();
  return impl_->tree.own_visits(impl_->pipeline().broad_phase()).mean;
}

std::int64_t World::visits_of(std::uint32_t id) {
  if (id >= impl_->initial.size())
    throw std::out_of_range("visits_of: there is no body " + std::to_string(id));
  return tree_quality().nodes > 0 ? impl_->tree.meter().visits_of(id) : 0;
}

BroadPhaseTimes World::time_broad_phase(int repeats) {
  detect();  // grows what is too small
  return collidoscope::time_broad_phase(impl_->executor, impl_->pipeline(), repeats);
}

std::vector<float> World::time_tree_queries(int repeats) {
  if (tree_quality().nodes == 0) return {};
  return collidoscope::time_tree_queries(impl_->executor, impl_->arranged_tree(), impl_->tree.meter(),
                                         repeats);
}

std::int64_t World::broad_phase_bytes() const { return impl_->pipeline().broad_phase_bytes(); }

PublishCounts World::publish_counts(int first_level, int last_level) {
  Impl& w = *impl_;
  detect();
  PublishCounts counts;
  counts.bodies = static_cast<std::int64_t>(w.initial.size());
  if (first_level <= last_level) {
    const std::vector<std::int64_t> sizes = tree_level_sizes();
    for (int level = std::max(0, first_level); level <= last_level && level < std::ssize(sizes); ++level)
      counts.boxes += sizes[static_cast<std::size_t>(level)];
  }
  counts.contacts = w.pipeline().control().contacts;
  counts.joints = w.pipeline().joints();
  return counts;
}

void World::publish(const PublishTarget& target) {
  Impl& w = *impl_;
  const bool boxes = target.boxes != nullptr;
  const PublishCounts counts = publish_counts(target.first_level, boxes ? target.last_level : -1);
  if ((target.bodies != nullptr && target.body_capacity < counts.bodies) ||
      (target.boxes != nullptr && target.box_capacity < counts.boxes) ||
      (target.contacts != nullptr && target.contact_capacity < counts.contacts) ||
      (target.joints != nullptr && target.joint_capacity < counts.joints))
    throw std::logic_error("publish: the target is smaller than publish_counts() says");
  w.keep_impulses();
  const bool by_visits = target.bodies != nullptr && target.body_color == BodyColor::visits;
  const bool by_tree = by_visits || (target.bodies != nullptr && (target.body_color == BodyColor::order ||
                                                                  target.body_color == BodyColor::depth));
  TreeValues values;
  if (boxes && target.box_metric != NodeMetric::level && tree_quality().nodes > 0)
    values.of_node = w.tree.meter().values(target.box_metric);
  if (by_visits && tree_quality().nodes > 0) values.of_body = w.tree.meter().body_visits();
  if (by_tree) detect();
  const bool by_error = target.body_color == BodyColor::error && w.errors.size() == w.initial.size();
  if (by_error && !w.drawn_errors)
    w.drawn_errors = std::make_unique<Buffer<float>>(w.executor, "errors of bodies to draw");
  if (by_error) w.drawn_errors->upload(w.errors);
  w.pipeline().publish(target, boxes || by_tree ? w.arranged_tree() : TreeView{}, values,
                       by_error ? w.drawn_errors->data() : nullptr);
  w.executor.synchronize();
}

void World::set_errors(std::vector<float> errors) { impl_->errors = std::move(errors); }
const std::vector<float>& World::errors() const { return impl_->errors; }

void* World::scratch(std::size_t bytes, int slot) {
  Impl& w = *impl_;
  while (w.scratch.size() <= static_cast<std::size_t>(slot))
    w.scratch.push_back(std::make_unique<Buffer<std::byte>>(w.executor, "scratch of the renderer"));
  Buffer<std::byte>& buffer = *w.scratch[static_cast<std::size_t>(slot)];
  if (buffer.size() < bytes) buffer.resize_discarding(bytes);
  return buffer.data();
}

void World::copy_to_host(void* host, const void* source, std::size_t bytes) {
  impl_->executor.copy_to_host(host, source, bytes);
}

}  // namespace collidoscope
