#include "sim_cuda/run/step_undo.h"

#include <chrono>
#include <new>

namespace collidoscope {

void StepUndo::begin_step(int runs) {
  backup_.clear();
  in_step_ = executor_.options().cancellation != nullptr && !executor_.on_device();
  runs_ = runs;
  if (in_step_ && runs > 1) start_ = Cancellation::Clock::now();
}

void StepUndo::before_writing(Pipeline& pipeline, const StepControl& control, double solve_seconds) {
  if (!in_step_ || backup_.has_copy() || to_the_end_) return;
  if (control.overflow) return;  // an overflowed run writes nothing
  double rest = runs_ * solve_seconds;
  if (runs_ > 1) {  // later runs find contacts again, in about the same time
    const std::chrono::duration<double> found = Cancellation::Clock::now() - start_;
    rest += (runs_ - 1) * found.count();
  }
  if (rest < executor_.options().cancellation->uninterrupted) {
    to_the_end_.emplace(executor_);
    return;
  }
  executor_.throw_if_cancelled();
  const Executor::Uninterrupted whole(executor_);
  try {
    backup_.save(executor_, [&](const ArrayVisitor& visit) { pipeline.visit_persistent_arrays(visit); });
  } catch (const std::bad_alloc&) {  // no memory for a copy
    backup_.clear();
    to_the_end_.emplace(executor_);
  }
}

void StepUndo::end_step() {
  backup_.clear();
  cancel_step();
}

void StepUndo::cancel_step() {
  to_the_end_.reset();
  in_step_ = false;
}

void StepUndo::undo() {
  backup_.restore(executor_);
  backup_.clear();
}

}  // namespace collidoscope
