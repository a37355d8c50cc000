#include "sim_cuda/stability/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <new>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/stability/hard_run.h"
#include "sim_cuda/stability/quantities.h"

namespace collidoscope {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Scene with_setting(Scene scene, const TrialSetting& setting) {
  scene.physics.solver = setting.solver;
  scene.physics.precision = setting.precision;
  return scene;
}

RunOptions with_way(RunOptions options, const Criterion& criterion, const TrialSetting& setting) {
  options.executor = setting.executor;
  Scene unused;
  apply(criterion.run, unused, options);
  return options;
}

std::vector<Change> changes_of(const HardCase& one, const Scene& scene, const RunOptions& options) {
  if (one.criterion.changes.empty()) return {};
  return read_changes(one.beside(one.criterion.changes), scene, options, 0).changes;
}

/// Whether it is measured once, when all runs have ended.
bool is_of_the_end(Quantity quantity) {
  return quantity == Quantity::other_hash || quantity == Quantity::found;
}

/// Why these settings cannot run the scene at all, a line; empty: they can.
std::string refusal_of(const Scene& scene) {
  const std::vector<Fault> faults = validate(scene);
  return faults.empty() ? "" : faults[0].path + ": " + faults[0].message;
}

}  // namespace

struct Trial::Impl {
  Impl(const HardCase& c, const TrialSetting& s, const RunOptions& o, bool extended, const CriterionFault* f)
      : one(c),
        setting(s),
        options(with_way(o, c.criterion, s)),
        steps(extended ? c.criterion.long_steps.value_or(c.criterion.steps) : c.criterion.steps),
        fault(f) {
    result.terms.resize(c.criterion.holds.size());
  }

  void work(const std::function<bool()>& late);
  void begin();
  bool due(std::int64_t state) const;
  void look();
  void judge(std::size_t term, const Extremes& extremes);
  void advance();
  void step();
  void end();
  bool found_it();
  void compare_refusal();
  void fail(const std::string& why);
  void finish();

  const HardCase& one;
  TrialSetting setting;
  RunOptions options;
  std::int64_t steps;
  const CriterionFault* fault;

  std::vector<Change> changes;
  std::optional<HardRun> run;
  std::map<std::string, HardRun> beside;  ///< scenes that are compared with, at the same state
  std::optional<Observation> seen;
  std::int64_t looked = 0;

  /// Another shape or broad phase of a term, run after this one.
  struct Other {
    std::size_t term;
    RunOptions options;
  };
  std::vector<Other> others;
  std::size_t next_other = 0;
  std::optional<HardRun> other;
  std::map<std::size_t, double> unlike;  ///< by term: other runs with another hash

  TrialResult result;
  bool failed = false, done = false;
};

void Trial::Impl::begin() {
  const Criterion& criterion = one.criterion;
  if (!criterion.executors.empty() &&
      std::ranges::find(criterion.executors, setting.executor) == criterion.executors.end()) {
    result.verdict = Verdict::not_applicable;
    result.why =
        fmt::format("runs on {} alone", criterion.executors[0] == ExecutorKind::cpu ? "a CPU" : "CUDA");
    done = true;
    return;
  }
  if (!criterion.refused.empty()) return compare_refusal();
  const Scene own = with_setting(one.scene, setting);
  std::string refusal = refusal_of(own);
  if (refusal.empty()) try {
      changes = changes_of(one, own, options);
    } catch (const InputError& error) {
      refusal = error.lines()[0];
    }
  if (!refusal.empty()) {
    result.verdict = Verdict::not_applicable;
    result.why = refusal;
    done = true;
    return;
  }
  for (const Term& term : criterion.holds)
    if (term.quantity == Quantity::difference && !beside.contains(term.scene))
      beside.try_emplace(term.scene, with_setting(one.others.at(term.scene), setting), options);
  for (std::size_t k = 0; k < criterion.holds.size(); ++k) {
    const Term& term = criterion.holds[k];
    if (term.quantity != Quantity::other_hash) continue;
    for (const LaunchShape& shape : term.shapes) others.emplace_back(k, options).options.shape = shape;
    for (const std::string& name :
         term.every_broad_phase ? broad_phase_names(setting.executor) : term.broad_phases)
      others.emplace_back(k, options).options.broad_phase = name;
  }
  Scene scene = fault != nullptr ? with_setting(with_fault(one, *fault), setting) : own;
  if (criterion.found) {
    scene.physics.guards = Guards{};
    if (scene.physics.effects) scene.physics.effects->guards = true;
  }
  run.emplace(scene, options, changes, fault != nullptr && fault->state ? fault->state : criterion.plant);
  seen.emplace(run->world(), criterion.holds);
  look();
}

void Trial::Impl::compare_refusal() {
  const std::vector<std::string>&wanted = one.criterion.refused, &found = one.refusal;
  done = true;
  if (found.empty()) return fail("the scene is read, and must be refused");
  if (found.size() != wanted.size())
    return fail(
        fmt::format("refused in {} lines, not in {}; the first: {}", found.size(), wanted.size(), found[0]));
  for (std::size_t k = 0; k < wanted.size(); ++k)
    if (found[k].find(wanted[k]) == std::string::npos)
      return fail(fmt::format("line {} of the refusal lacks \"{}\": {}", k + 1, wanted[k], found[k]));
}

bool Trial::Impl::due(std::int64_t state) const {
  return state % one.criterion.every == 0 || state == steps ||
         std::ranges::any_of(one.criterion.holds,
                             [&](const Term& term) {
                               return term.from == state || term.to == state ||
                                      (term.quantity == Quantity::displacement && term.since == state);
                             }) ||
         (fault != nullptr && fault->state && fault->state->step == state);
}

void Trial::Impl::look() {
  const std::int64_t state = run->state();
  if (state > 0) seen->look(run->world(), run->seconds());
  for (std::size_t k = 0; k < one.criterion.holds.size() && !done; ++k) {
    const Term& term = one.criterion.holds[k];
    if (is_of_the_end(term.quantity) || !term.at(state)) continue;
    judge(k, term.quantity == Quantity::difference
                 ? difference(term, seen->bodies(), beside.at(term.scene).world().bodies())
                 : measured(term, *seen));
  }
  if (!failed) result.last_good = state;
  looked = state;
}

/// Notes what a term came to at this state; the trial ends where it does not hold. With a fault, it goes on
/// to the term that the fault is to fail.
void Trial::Impl::judge(std::size_t k, const Extremes& extremes) {
  const Term& term = one.criterion.holds[k];
  TermResult& known = result.terms[k];
  const auto bounded = [&](double value, std::optional<double> bound, bool above,
                           std::optional<std::uint32_t> body) {
    if (!bound || !known.held) return;
    const bool held = above ? value <= *bound : value >= *bound;
    const double room = above ? *bound - value : value - *bound;
    const double least = known.value <= known.bound ? known.bound - known.value : known.value - known.bound;
    if (held && known.measured && !(room < least)) return;
    known = {true, held, value, *bound, run->state(), body};
  };
  bounded(extremes.most, term.at_most, true, extremes.most_body);
  bounded(extremes.least, term.at_least, false, extremes.least_body);
  if (known.held) return;
  if (fault != nullptr) {
    done = done || fault->term == k;
    return;
  }
  if (!known.body) known.body = culprit(term, *seen);
  result.failed_term = k;
  if (term.quantity == Quantity::found)
    return fail(
        text_of(term) + ": " +
        (run->world().guards().finding() ? describe(*run->world().guards().finding()) : "they find nothing"));
  fail(fmt::format("{}: {} at state {}{}", text_of(term), text_of(term.quantity, known.value), known.state,
                   known.body ? fmt::format(", body {}", *known.body) : ""));
}

void Trial::Impl::fail(const std::string& why) {
  failed = done = true;
  result.failure = why;
}

void Trial::Impl::step() {
  run->step();
  if (run->world().guards().paused() && !one.criterion.found)
    return fail(describe(*run->world().guards().finding()));
  for (auto& [name, scene] : beside) scene.step();
  if (due(run->state())) look();
}

/// All runs are at their ends.
void Trial::Impl::end() {
  for (std::size_t k = 0; k < one.criterion.holds.size() && !done; ++k) {
    const Quantity quantity = one.criterion.holds[k].quantity;
    if (!is_of_the_end(quantity)) continue;
    Extremes value;
    value.take(quantity == Quantity::found ? (found_it() ? 1 : 0) : unlike[k]);
    judge(k, value);
  }
  done = true;
}

/// Whether guards found what they must, and that first.
bool Trial::Impl::found_it() {
  const MustFind& wanted = *one.criterion.found;
  const std::optional<Finding>& finding = run->world().guards().finding();
  return finding && finding->step == wanted.step && finding->stage == wanted.stage &&
         finding->body == wanted.body;
}

/// At least a step of a run, then more until it is late.
void Trial::Impl::work(const std::function<bool()>& late) {
  if (!run) begin();
  while (!done) {
    advance();
    if (late()) return;
  }
}

void Trial::Impl::advance() {
  if (run->state() < steps && !run->world().guards().paused()) return step();
  if (next_other == others.size()) return end();
  if (!other) other.emplace(with_setting(one.scene, setting), others[next_other].options, changes);
  if (other->state() < steps && !other->world().guards().paused()) return other->step();
  const bool like = other->world().state_hash() == run->world().state_hash();
  unlike[others[next_other].term] += like ? 0 : 1;
  other.reset();
  ++next_other;
}

void Trial::Impl::finish() {
  const DeclaredLimit* limit =
      one.criterion.refused.empty()
          ? one.criterion.limit_of(setting.solver, setting.precision, setting.executor)
          : nullptr;
  if (run) {
    result.steps = run->state();
    result.state_hash = run->world().state_hash();
  }
  other.reset();
  seen.reset();
  beside.clear();
  run.reset();
  if (result.verdict == Verdict::not_applicable || fault != nullptr) return;
  if (failed && limit != nullptr) {
    result.verdict = Verdict::declared_limit;
    result.why = limit->why;
  } else if (failed) {
    result.verdict = Verdict::failed;
    result.why = result.failure;
  } else if (limit != nullptr) {
    result.verdict = Verdict::failed;
    result.why = fmt::format("holds, where a limit is declared: remove it (\"{}\")", limit->why);
  }
}

Trial::Trial(const HardCase& one, const TrialSetting& setting, const RunOptions& options, bool extended,
             const CriterionFault* fault)
    : impl_(std::make_unique<Impl>(one, setting, options, extended, fault)) {}
Trial::~Trial() = default;
Trial::Trial(Trial&&) noexcept = default;

bool Trial::go_on(double milliseconds) {
  Impl& trial = *impl_;
  if (trial.done) return false;
  const Clock::time_point start = Clock::now();
  try {
    trial.work([&] { return seconds_since(start) * 1000 > milliseconds; });
    trial.result.seconds += seconds_since(start);
    if (trial.done) trial.finish();
    return !trial.done;
  } catch (const InputError& error) {
    trial.fail(error.lines()[0]);
  } catch (const std::bad_alloc&) {
    trial.fail("out of memory");
  } catch (const std::exception& error) {
    trial.fail(error.what());
  }
  trial.result.seconds += seconds_since(start);
  trial.run.reset();
  trial.finish();
  return false;
}

bool Trial::done() const { return impl_->done; }

double Trial::progress() const {
  const Impl& trial = *impl_;
  if (trial.done) return 1;
  if (!trial.run || trial.steps == 0) return 0;
  const double runs = 1 + static_cast<double>(trial.others.size());
  const double states =
      static_cast<double>(trial.run->state()) + (trial.other ? static_cast<double>(trial.other->state()) : 0);
  return (states / static_cast<double>(trial.steps) + static_cast<double>(trial.next_other)) / runs;
}

const TrialResult& Trial::result() const { return impl_->result; }
std::int64_t Trial::bodies() const {
  const Scene& scene = impl_->one.scene;
  auto count = static_cast<std::int64_t>(scene.bodies.size() + scene.added.size());
  for (const BoxCollider& generator : scene.generators) count += generator.count;
  return count;
}

const TrialSetting& Trial::setting() const { return impl_->setting; }
bool Trial::fault_shows() const {
  return impl_->fault != nullptr && !impl_->result.terms[impl_->fault->term].held;
}

std::vector<TrialSetting> trials_of(const HardCase& one, ExecutorKind executor) {
  if (!one.criterion.refused.empty()) return {{Solver::soft_step, Precision::f32, executor}};
  std::vector<TrialSetting> settings;
  for (const Named<Solver>& solver : solver_names)
    for (const Named<Precision>& precision : precision_names)
      settings.push_back({solver.value, precision.value, executor});
  return settings;
}

TrialSetting setting_of(const HardCase& one, const CriterionFault& fault, ExecutorKind executor) {
  const Physics& physics = with_fault(one, fault).physics;
  return {physics.solver, physics.precision, executor};
}

TrialStart start_of(const HardCase& one, const TrialSetting& setting, const RunOptions& options) {
  TrialStart start{with_setting(one.scene, setting), with_way(options, one.criterion, setting), {}};
  start.changes = changes_of(one, start.scene, start.options);
  return start;
}

Snapshot state_in_trial(const HardCase& one, const TrialSetting& setting, const RunOptions& options,
                        std::int64_t state) {
  TrialStart start = start_of(one, setting, options);
  HardRun run(std::move(start.scene), std::move(start.options), std::move(start.changes));
  while (run.state() < state) run.step();
  return snapshot_of(run.world());
}

}  // namespace collidoscope
