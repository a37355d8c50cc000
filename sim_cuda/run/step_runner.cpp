#include "sim_cuda/run/step_runner.h"

#include <algorithm>
#include <string>

#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/elapsed.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/run/step_estimate.h"

namespace collidoscope {
namespace {

constexpr std::int64_t max_list_length = 2147483647;  // counts have 32 bits

std::int64_t grown(std::uint64_t needed, std::int64_t capacity, const char* what, std::size_t bytes_each) {
  if (needed <= static_cast<std::uint64_t>(capacity)) return capacity;
  if (needed > static_cast<std::uint64_t>(max_list_length))
    throw MachineError("a step has " + std::to_string(needed) + ' ' + what + ", which need " +
                       std::to_string(needed * bytes_each) + " bytes; this build supports at most " +
                       std::to_string(max_list_length) +
                       "; use fewer bodies, or a variant whose pairs grow as N (scaled)");
  return std::min<std::int64_t>(max_list_length, static_cast<std::int64_t>(needed + needed / 2));
}

}  // namespace

StepRunner::StepRunner(Executor& executor, std::unique_ptr<Pipeline> pipeline, Capacity capacity)
    : executor_(executor), pipeline_(std::move(pipeline)) {
  reserve({std::min(capacity.pairs, max_list_length), std::min(capacity.contacts, max_list_length)});
}

void StepRunner::discard_graphs() {
  plain_.reset();
  timed_.reset();
  executor_.synchronize();
}

void StepRunner::replace(std::unique_ptr<Pipeline> pipeline) {
  discard_graphs();
  pipeline_ = std::move(pipeline);
  committed_ = 0;
}

void StepRunner::recreate(const std::function<std::unique_ptr<Pipeline>()>& make) {
  discard_graphs();
  const Capacity capacity = pipeline_->capacity();
  is_unusable_ = true;
  pipeline_->reserve({0, 0});
  std::unique_ptr<Pipeline> next = make();
  next->reserve(capacity);
  replace(std::move(next));
  is_unusable_ = false;
}

void StepRunner::discard_runs() {
  pipeline_->clear_overflow();
  pipeline_->clear_violation();
  committed_ = pipeline_->control().committed;
}

std::optional<FirstViolation> StepRunner::step(bool timed) {
  require_memory();
  const std::uint32_t target = next();
  for (bool done = false; !done;) {
    done = timed ? run_timed(target) : run_plain(target);
    if (auto found = pipeline_->first_violation()) return found;
    if (!done) grow();
  }
  return std::nullopt;
}

void StepRunner::detect() {
  require_memory();
  do pipeline_->detect();
  while (grow());
}

// ---- memory ----

void StepRunner::require_memory() const {
  if (is_unusable_)
    throw MachineError(
        "out of memory within a step: this run has no valid state to continue from; restart it");
}

void StepRunner::reserve(Capacity capacity) {
  discard_graphs();
  const Capacity before = pipeline_->capacity();
  try {
    pipeline_->reserve(capacity);
  } catch (...) {
    is_unusable_ = true;
    pipeline_->reserve(before);  // reallocate freed buffers
    is_unusable_ = false;
    throw;
  }
}

/// Bytes missing for a capacity; 0 if there is enough memory.
std::int64_t StepRunner::missing_bytes(Capacity capacity) {
  const std::int64_t more = executor_.dry_run_allocation([&] { pipeline_->reserve(capacity); });
  executor_.dry_run_allocation([&] { pipeline_->reserve(pipeline_->capacity()); });
  return std::max<std::int64_t>(more - executor_.room_bytes(), 0);
}

/// Grows the lists after an overflow. Returns true if there was one.
bool StepRunner::grow() {
  const StepControl control = pipeline_->control();
  if (!control.overflow) return false;
  executor_.throw_if_cancelled();
  const Capacity now = pipeline_->capacity();
  Capacity wanted{grown(control.pairs_needed, now.pairs, "pairs", sizeof(std::uint32_t)),
                  grown(control.contacts_needed, now.contacts, "contacts", 64)};
  if (missing_bytes(wanted) > 0) {
    // Retry with the exact lengths. If they do not fit either, nothing changes.
    wanted = {std::max(now.pairs, static_cast<std::int64_t>(control.pairs_needed)),
              std::max(now.contacts, static_cast<std::int64_t>(control.contacts_needed))};
    if (const std::int64_t bytes = missing_bytes(wanted); bytes > 0) {
      const ExecutorOptions& options = executor_.options();
      const std::int64_t given = executor_.allocated_bytes() + executor_.room_bytes();
      const bool by_rule = options.memory_limit == 0 && !options.allow_large;
      const std::string found =
          "a step has " + std::to_string(control.pairs_needed) + " pairs" +
          (control.pairs > 0 ? " and " + std::to_string(control.contacts_needed) + " contacts, which need "
                             : ", which need at least ");
      const std::string rule = by_rule ? " (80 % of its available memory)" : "";
      const std::string advice = "; use fewer bodies, or a variant whose pairs grow as N (scaled)";
      throw TooLarge(found + std::to_string(given + bytes) + " bytes including the rest of the scene; " +
                         executor_.device_name() + " provides " + std::to_string(given) + rule + advice +
                         (by_rule ? ", or --allow-large" : ""),
                     found + short_bytes(static_cast<double>(given + bytes)) +
                         " including the rest of the scene; " + executor_.device_name() + " provides " +
                         short_bytes(static_cast<double>(given)) + rule + advice);
    }
  }
  reserve(wanted);
  pipeline_->clear_overflow();
  return true;
}

// ---- runs ----

/// Launches a run. If it fails halfway, the state is lost. If it is cancelled, Simulation restores the
/// state.
void StepRunner::launch(StepGraph& graph) {
  is_unusable_ = true;
  try {
    graph.launch();
  } catch (const Cancelled&) {
    is_unusable_ = false;
    executor_.clock().discard_step();
    throw;
  }
  is_unusable_ = false;
}

StepGraph& StepRunner::graph(bool timed) {
  std::unique_ptr<StepGraph>& wanted = timed ? timed_ : plain_;
  if (!wanted) wanted = std::make_unique<StepGraph>(executor_, timed, [this] { pipeline_->run(); });
  return *wanted;
}

/// Runs until `target` runs are committed. Returns false if a run overflowed.
bool StepRunner::run_timed(std::uint32_t target) {
  while (committed_ != target) {
    StepGraph& g = graph(true);
    launch(g);
    executor_.synchronize();
    control_ = pipeline_->control();
    if (control_.overflow) {
      executor_.clock().discard_step();
      return false;
    }
    committed_ = control_.committed;
    g.collect();
  }
  executor_.clock().commit_step();
  return true;
}

bool StepRunner::run_plain(std::uint32_t target) {
  StepGraph& g = graph(false);
  const bool whole = target - committed_ == static_cast<std::uint32_t>(pipeline_->runs_per_step());
  const double milliseconds = milliseconds_of(executor_, [&] {
    for (std::uint32_t run = committed_; run != target; ++run) launch(g);
  });
  control_ = pipeline_->control();
  committed_ = control_.committed;
  if (control_.overflow) return false;
  if (whole) executor_.clock().add_plain_step(milliseconds);
  return true;
}

}  // namespace collidoscope
