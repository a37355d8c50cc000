#include "sim_cuda/solver/contact_impulses.h"

namespace collidoscope {

namespace {

template <class Real>
struct KeepImpulses {
  const Pair* contacts;
  const Real* impulse;
  Pair* kept_contacts;
  Real* kept_impulse;
  SIM_HD void operator()(int contact) const {
    kept_contacts[contact] = contacts[contact];
    kept_impulse[contact] = impulse[contact];
  }
};

struct KeepCount {
  const StepControl* control;
  std::uint32_t* count;
  SIM_HD void operator()(int) const { *count = control->contacts; }
};

}  // namespace

template <class Real>
ContactImpulses<Real>::ContactImpulses(Executor& executor)
    : executor_(executor),
      impulse_(executor, "contact impulses"),
      kept_contacts_(executor, "previous contacts"),
      kept_impulse_(executor, "previous impulses"),
      kept_count_(executor, "previous contact count") {}

template <class Real>
void ContactImpulses<Real>::enable(bool on) {
  enabled_ = on;
  impulse_.resize_discarding(on ? static_cast<std::size_t>(capacity_) : 0);
  if (on) return;
  kept_contacts_.resize_discarding(0);
  kept_impulse_.resize_discarding(0);
  kept_count_.resize_discarding(0);
}

template <class Real>
void ContactImpulses<Real>::reserve(std::int64_t capacity) {
  capacity_ = capacity;
  if (enabled_) impulse_.resize_discarding(static_cast<std::size_t>(capacity));
}

template <class Real>
void ContactImpulses<Real>::keep(const Pair* contacts, const StepControl* control) {
  if (!enabled_) return;
  kept_contacts_.resize_discarding(impulse_.size());
  kept_impulse_.resize_discarding(impulse_.size());
  kept_count_.resize_discarding(1);
  executor_.run("publish", ItemCount(&control->contacts, capacity_),
                KeepImpulses<Real>{contacts, impulse_.data(), kept_contacts_.data(), kept_impulse_.data()});
  executor_.run("publish", 1, KeepCount{control, kept_count_.data()});
}

template <class Real>
ImpulseView<Real> ContactImpulses<Real>::view() const {
  return {kept_contacts_.data(), kept_impulse_.data(), kept_count_.data()};
}

template class ContactImpulses<float>;
template class ContactImpulses<double>;

}  // namespace collidoscope
