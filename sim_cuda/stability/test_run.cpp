#include "sim_cuda/stability/test_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <new>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/stability/hard_case_simulation.h"
#include "sim_cuda/stability/quantities.h"
#include "sim_cuda/stability/verdict.h"

namespace collidoscope {
namespace {

using Clock = std::chrono::steady_clock;

Scene with_configuration(Scene scene, const TestConfiguration& configuration) {
  scene.physics.solver = configuration.solver;
  scene.physics.precision = configuration.precision;
  return scene;
}

RunOptions with_run_settings(RunOptions options, const Criterion& criterion,
                             const TestConfiguration& configuration) {
  options.executor = configuration.executor;
  Scene unused;
  apply(criterion.run, unused, options);
  return options;
}

std::vector<Change> changes_of(const HardCase& hard_case, const Scene& scene, const RunOptions& options) {
  if (hard_case.criterion.changes.empty()) return {};
  return read_changes(hard_case.sibling_path(hard_case.criterion.changes), scene, options, 0).changes;
}

/// True if the quantity is measured once, after all runs have ended.
bool is_checked_at_end(Quantity quantity) {
  return quantity == Quantity::other_hash || quantity == Quantity::expected_finding;
}

/// The reason why the scene is invalid with these settings, one line. Empty if it is valid.
std::string refusal_of(const Scene& scene) {
  const std::vector<Fault> faults = validate(scene);
  return faults.empty() ? "" : faults[0].path + ": " + faults[0].message;
}

}  // namespace

struct TestRun::Impl {
  Impl(const HardCase& c, const TestConfiguration& s, const RunOptions& o, bool extended,
       const InjectedFault* f)
      : hard_case(c),
        configuration(s),
        options(with_run_settings(o, c.criterion, s)),
        steps(extended ? c.criterion.long_steps.value_or(c.criterion.steps) : c.criterion.steps),
        fault(f) {
    result.assertions.resize(c.criterion.assertions.size());
  }

  void work(const std::function<bool()>& late);
  void begin();
  void skip(const std::string& why);
  bool due(std::int64_t state) const;
  void check_assertions();
  void evaluate(std::size_t assertion, const Extremes& extremes);
  void advance();
  void step();
  void end();
  bool has_expected_finding();
  void compare_refusal();
  void fail(const std::string& why);
  void finish();

  const HardCase& hard_case;
  TestConfiguration configuration;
  RunOptions options;
  std::int64_t steps;
  const InjectedFault* fault;

  std::vector<Change> changes;
  std::optional<HardCaseSimulation> run;
  std::map<std::string, HardCaseSimulation> compared_runs;  ///< scenes compared with, at the same state
  std::optional<Observation> observation;
  std::int64_t last_checked = 0;

  /// A further run of an assertion with another shape or broad phase.
  struct Other {
    std::size_t assertion;
    RunOptions options;
  };
  std::vector<Other> others;
  std::size_t next_other = 0;
  std::optional<HardCaseSimulation> other;
  std::map<std::size_t, double> differing_hashes;  ///< by assertion: number of other runs with a different
                                                   ///< hash

  TestResult result;
  std::string other_finding;  ///< of the guards, if one was expected and another came
  bool failed = false, broken = false, done = false;
};

void TestRun::Impl::begin() {
  const Criterion& criterion = hard_case.criterion;
  if (!criterion.executors.empty() &&
      std::ranges::find(criterion.executors, configuration.executor) == criterion.executors.end()) {
    return skip(
        fmt::format("runs only on {}", criterion.executors[0] == ExecutorKind::cpu ? "a CPU" : "CUDA"));
  }
  if (!criterion.solvers.empty() &&
      std::ranges::find(criterion.solvers, configuration.solver) == criterion.solvers.end())
    return skip(fmt::format("not made for {}", name_of(solver_names, configuration.solver)));
  if (!criterion.refused.empty()) return compare_refusal();
  const Scene own = with_configuration(hard_case.scene, configuration);
  std::string refusal = refusal_of(own);
  if (refusal.empty()) try {
      changes = changes_of(hard_case, own, options);
    } catch (const InputError& error) {
      refusal = error.lines()[0];
    }
  if (!refusal.empty()) return skip(refusal);
  for (const Assertion& assertion : criterion.assertions)
    if (assertion.quantity == Quantity::difference && !compared_runs.contains(assertion.scene))
      compared_runs.try_emplace(
          assertion.scene, with_configuration(hard_case.others.at(assertion.scene), configuration), options);
  for (std::size_t k = 0; k < criterion.assertions.size(); ++k) {
    const Assertion& assertion = criterion.assertions[k];
    if (assertion.quantity != Quantity::other_hash) continue;
    for (const LaunchShape& shape : assertion.shapes)
      others.emplace_back(Other{k, options}).options.shape = shape;
    for (const std::string& name :
         assertion.every_broad_phase ? broad_phase_names(configuration.executor) : assertion.broad_phases)
      others.emplace_back(Other{k, options}).options.broad_phase = name;
  }
  Scene scene =
      fault != nullptr ? with_configuration(with_injected_fault(hard_case, *fault), configuration) : own;
  if (criterion.expected_finding) {
    scene.physics.guards = ValidationSettings{};
    if (scene.physics.effects) scene.physics.effects->guards = true;
  }
  run.emplace(scene, options, changes,
              fault != nullptr && fault->state ? fault->state : criterion.injected_state);
  observation.emplace(run->world(), criterion.assertions);
  check_assertions();
}

void TestRun::Impl::skip(const std::string& why) {
  result.outcome = TestOutcome::not_applicable;
  result.why = why;
  done = true;
}

void TestRun::Impl::compare_refusal() {
  const std::vector<std::string>&wanted = hard_case.criterion.refused, &found = hard_case.refusal;
  done = true;
  if (found.empty()) return fail("the scene was accepted; it must be refused");
  if (found.size() != wanted.size())
    return fail(fmt::format("refused with {} lines, expected {}; the first line: {}", found.size(),
                            wanted.size(), found[0]));
  for (std::size_t k = 0; k < wanted.size(); ++k)
    if (found[k].find(wanted[k]) == std::string::npos)
      return fail(
          fmt::format("line {} of the refusal does not contain \"{}\": {}", k + 1, wanted[k], found[k]));
}

bool TestRun::Impl::due(std::int64_t state) const {
  return state % hard_case.criterion.every == 0 || state == steps ||
         std::ranges::any_of(
             hard_case.criterion.assertions,
             [&](const Assertion& assertion) {
               return assertion.from == state || assertion.to == state ||
                      (assertion.quantity == Quantity::displacement && assertion.since == state);
             }) ||
         (fault != nullptr && fault->state && fault->state->step == state);
}

void TestRun::Impl::check_assertions() {
  const std::int64_t state = run->state();
  if (state > 0) observation->update(run->world(), run->seconds());
  for (std::size_t k = 0; k < hard_case.criterion.assertions.size() && !done; ++k) {
    const Assertion& assertion = hard_case.criterion.assertions[k];
    if (is_checked_at_end(assertion.quantity) || !assertion.at(state)) continue;
    evaluate(k, assertion.quantity == Quantity::difference
                    ? difference(assertion, observation->bodies(),
                                 compared_runs.at(assertion.scene).world().bodies())
                    : measured(assertion, *observation));
  }
  if (!failed) result.last_passing_state = state;
  last_checked = state;
}

/// Updates the result of an assertion at this state. With an injected fault, the fault's assertion ends the
/// test run when it fails.
void TestRun::Impl::evaluate(std::size_t k, const Extremes& extremes) {
  const Assertion& assertion = hard_case.criterion.assertions[k];
  AssertionResult& known = result.assertions[k];
  const bool held = known.passed;
  update(known, assertion, extremes, run->state());
  if (known.passed || !held) return;
  if (fault != nullptr) {
    done = done || fault->assertion == k;
    return;
  }
  if (!known.body) known.body = offending_body(assertion, *observation);
  if (!result.failed_assertion) result.failed_assertion = k;
  failed = true;
  // Other quantities of bodies that are not finite mean nothing.
  if (assertion.quantity == Quantity::finite) done = true;
}

/// Ends the run for a reason that is no assertion. No declared limit excuses it.
void TestRun::Impl::fail(const std::string& why) {
  broken = failed = done = true;
  result.failure = why;
}

void TestRun::Impl::step() {
  run->step();
  if (run->world().validation().paused() && !hard_case.criterion.expected_finding)
    return fail(describe(*run->world().validation().finding()));
  for (auto& [name, scene] : compared_runs) scene.step();
  if (due(run->state())) check_assertions();
}

/// Evaluates the final assertions. All runs have ended.
void TestRun::Impl::end() {
  for (std::size_t k = 0; k < hard_case.criterion.assertions.size() && !done; ++k) {
    const Quantity quantity = hard_case.criterion.assertions[k].quantity;
    if (!is_checked_at_end(quantity)) continue;
    Extremes value;
    if (quantity == Quantity::expected_finding && run->world().validation().finding())
      other_finding = describe(*run->world().validation().finding());
    value.add(quantity == Quantity::expected_finding ? (has_expected_finding() ? 1 : 0)
                                                     : differing_hashes[k]);
    evaluate(k, value);
  }
  done = true;
}

/// True if the first finding of the guards is the expected one.
bool TestRun::Impl::has_expected_finding() {
  const ExpectedFinding& wanted = *hard_case.criterion.expected_finding;
  const std::optional<Finding>& finding = run->world().validation().finding();
  return finding && finding->step == wanted.step && finding->stage == wanted.stage &&
         finding->body == wanted.body;
}

/// Makes at least one step, then continues until `late` returns true.
void TestRun::Impl::work(const std::function<bool()>& late) {
  if (!run) begin();
  while (!done) {
    advance();
    if (late()) return;
  }
}

void TestRun::Impl::advance() {
  if (run->state() < steps && !run->world().validation().paused()) return step();
  if (next_other == others.size()) return end();
  if (!other)
    other.emplace(with_configuration(hard_case.scene, configuration), others[next_other].options, changes);
  if (other->state() < steps && !other->world().validation().paused()) return other->step();
  const bool like = other->world().state_hash() == run->world().state_hash();
  differing_hashes[others[next_other].assertion] += like ? 0 : 1;
  other.reset();
  ++next_other;
}

void TestRun::Impl::finish() {
  const ExpectedFailure* limit =
      hard_case.criterion.refused.empty()
          ? hard_case.criterion.expected_failure_of(configuration.solver, configuration.precision,
                                                    configuration.executor)
          : nullptr;
  if (run) {
    result.steps = run->state();
    result.state_hash = run->world().state_hash();
  }
  other.reset();
  observation.reset();
  compared_runs.clear();
  run.reset();
  if (result.outcome != TestOutcome::not_applicable && fault == nullptr)
    judge(result, hard_case.criterion.assertions, limit, broken, other_finding);
}

TestRun::TestRun(const HardCase& hard_case, const TestConfiguration& configuration, const RunOptions& options,
                 bool extended, const InjectedFault* fault)
    : impl_(std::make_unique<Impl>(hard_case, configuration, options, extended, fault)) {}
TestRun::~TestRun() = default;
TestRun::TestRun(TestRun&&) noexcept = default;

bool TestRun::advance(double milliseconds) {
  Impl& test_run = *impl_;
  if (test_run.done) return false;
  const Clock::time_point start = Clock::now();
  try {
    test_run.work([&] { return seconds_since(start) * 1000 > milliseconds; });
    test_run.result.seconds += seconds_since(start);
    if (test_run.done) test_run.finish();
    return !test_run.done;
  } catch (const InputError& error) {
    test_run.fail(error.lines()[0]);
  } catch (const std::bad_alloc&) {
    test_run.fail("out of memory");
  } catch (const std::exception& error) {
    test_run.fail(error.what());
  }
  test_run.result.seconds += seconds_since(start);
  test_run.run.reset();
  test_run.finish();
  return false;
}

bool TestRun::done() const { return impl_->done; }

double TestRun::progress() const {
  const Impl& test_run = *impl_;
  if (test_run.done) return 1;
  if (!test_run.run || test_run.steps == 0) return 0;
  const double runs = 1 + static_cast<double>(test_run.others.size());
  const double states = static_cast<double>(test_run.run->state()) +
                        (test_run.other ? static_cast<double>(test_run.other->state()) : 0);
  return (states / static_cast<double>(test_run.steps) + static_cast<double>(test_run.next_other)) / runs;
}

const TestResult& TestRun::result() const { return impl_->result; }
std::int64_t TestRun::bodies() const { return bodies_of(impl_->hard_case.scene); }

const TestConfiguration& TestRun::configuration() const { return impl_->configuration; }
bool TestRun::fault_detected() const {
  return impl_->fault != nullptr && !impl_->result.assertions[impl_->fault->assertion].passed;
}

std::vector<TestConfiguration> test_configurations(const HardCase& hard_case, ExecutorKind executor) {
  if (!hard_case.criterion.refused.empty()) return {{Solver::soft_step, Precision::f32, executor}};
  std::vector<TestConfiguration> settings;
  for (const Named<Solver>& solver : solver_names)
    for (const Named<Precision>& precision : precision_names)
      settings.push_back({solver.value, precision.value, executor});
  return settings;
}

TestConfiguration configuration_of(const HardCase& hard_case, const InjectedFault& fault,
                                   ExecutorKind executor) {
  const Physics& physics = with_injected_fault(hard_case, fault).physics;
  return {physics.solver, physics.precision, executor};
}

TestSetup make_test_setup(const HardCase& hard_case, const TestConfiguration& configuration,
                          const RunOptions& options) {
  TestSetup start{with_configuration(hard_case.scene, configuration),
                  with_run_settings(options, hard_case.criterion, configuration),
                  {}};
  start.changes = changes_of(hard_case, start.scene, start.options);
  return start;
}

Snapshot replay_to_state(const HardCase& hard_case, const TestConfiguration& configuration,
                         const RunOptions& options, std::int64_t state) {
  TestSetup start = make_test_setup(hard_case, configuration, options);
  HardCaseSimulation run(std::move(start.scene), std::move(start.options), std::move(start.changes));
  while (run.state() < state) run.step();
  return snapshot_of(run.world());
}

}  // namespace collidoscope
