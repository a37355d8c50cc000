#include "sim_cuda/solver/sleeping.h"

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/disjoint_sets.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/scene/effects.h"
#include "sim_cuda/solver/warm_start.h"

namespace collidoscope {

namespace {

struct BeginIslands {
  std::uint32_t* parent;
  std::uint8_t *island_active, *asleep;
  SIM_HD void operator()(int body) const {
    parent[body] = static_cast<std::uint32_t>(body);
    island_active[body] = asleep[body] = 0;
  }
};

/// Joins the islands of two bodies.
template <class Real>
struct Islands {
  BodyView<Real> bodies;
  std::uint32_t* parent;
  std::uint8_t* disturbed;  ///< by body: a moving kinematic body touches it

  SIM_HD bool moves(std::uint32_t body) const {
    const Vector3<Real> v = bodies.velocity[body];
    bool some = v.dot(v) > 0;
    if (bodies.angular_velocity != nullptr) {
      const Vector3<Real> angular_velocity = bodies.angular_velocity[body];
      some = some || angular_velocity.dot(angular_velocity) > 0;
    }
    return some;
  }
  SIM_HD void join(std::uint32_t a, std::uint32_t b) const {
    const bool a_stays = bodies.inverse_mass[a] == 0, b_stays = bodies.inverse_mass[b] == 0;
    if (a_stays || b_stays) {
      if (a_stays && moves(a)) atomic_store(&disturbed[b], std::uint8_t{1});
      if (b_stays && moves(b)) atomic_store(&disturbed[a], std::uint8_t{1});
      return;
    }
    join_sets(parent, a, b);
  }
};

template <class Real>
struct JoinByContacts {
  const Pair* contacts;
  Islands<Real> islands;
  SIM_HD void operator()(int contact) const { islands.join(contacts[contact].a, contacts[contact].b); }
};

template <class Real>
struct JoinByJoints {
  const JointRow<Real>* rows;
  Islands<Real> islands;
  SIM_HD void operator()(int joint) const {
    if (rows[joint].b != JointRow<Real>::world) islands.join(rows[joint].a, rows[joint].b);
  }
};

/// Marks islands with a body that is not at rest. Components are complete.
struct MarkActiveIslands {
  const std::uint32_t* sleep_timer;
  std::uint32_t steps_to_sleep;
  std::uint32_t* parent;
  const std::uint8_t* disturbed;
  std::uint8_t* island_active;
  SIM_HD void operator()(int body) const {
    if (sleep_timer[body] < steps_to_sleep || disturbed[body])
      atomic_store(&island_active[root_of(parent, static_cast<std::uint32_t>(body))], std::uint8_t{1});
  }
};

template <class Real>
struct FallAsleepOrWake {
  BodyView<Real> bodies;
  std::uint32_t* parent;
  const std::uint8_t* island_active;
  std::uint32_t* sleep_timer;
  std::uint8_t* asleep;
  const StepControl* control;
  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    const bool sleeps = island_active[root_of(parent, static_cast<std::uint32_t>(body))] == 0 &&
                        bodies.inverse_mass[body] > 0;
    const bool slept = sleep_timer[body] == asleep_marker;
    asleep[body] = sleeps ? 1 : 0;
    if (sleeps == slept) return;
    sleep_timer[body] = sleeps ? asleep_marker : 0;
    if (!sleeps) return;
    bodies.velocity[body] = Vector3<Real>::Zero();
    if (bodies.angular_velocity != nullptr) bodies.angular_velocity[body] = Vector3<Real>::Zero();
  }
};

template <class Real>
struct UpdateSleepTimers {
  BodyView<Real> bodies;
  Real speed;
  std::uint32_t steps_to_sleep;
  std::uint32_t* sleep_timer;
  const StepControl* control;
  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    const Vector3<Real> v = bodies.velocity[body];
    bool is_slow = v.dot(v) < speed * speed;
    if (bodies.angular_velocity != nullptr) {
      const Vector3<Real> surface = bodies.radius[body] * bodies.angular_velocity[body].load();
      is_slow = is_slow && surface.dot(surface) < speed * speed;
    }
    sleep_timer[body] = is_slow ? min_of(sleep_timer[body] + 1, steps_to_sleep) : 0;
  }
};

/// Counts each island once, at its root.
template <class Real>
struct CountSleepers {
  BodyView<Real> bodies;
  const std::uint32_t *parent, *sleep_timer;
  SIM_HD SleepSums operator()(std::int64_t body) const {
    const std::int64_t asleep = sleep_timer[body] == asleep_marker ? 1 : 0;
    const std::int64_t root =
        parent[body] == static_cast<std::uint32_t>(body) && bodies.inverse_mass[body] > 0 ? 1 : 0;
    return {asleep, root, root & asleep};
  }
};

/// Parents before the first run: no body is a root.
std::vector<std::uint32_t> no_islands(std::int64_t bodies) {
  return std::vector<std::uint32_t>(static_cast<std::size_t>(bodies), 0xffffffffu);
}

}  // namespace

template <class Real>
Sleeping<Real>::Sleeping(Executor& executor)
    : executor_(executor),
      sleep_timer_(executor, "sleep timers"),
      parent_(executor, "islands"),
      island_active_(executor, "active islands"),
      asleep_(executor, "sleeping bodies"),
      sums_(executor, "island sums") {}

template <class Real>
void Sleeping<Real>::enable(const BodyView<Real>& bodies, std::int64_t body_count, const Sleep& sleep,
                            double time_step, const StepControl* control) {
  bodies_ = bodies;
  body_count_ = body_count;
  speed_ = static_cast<Real>(sleep.speed);
  steps_to_sleep_ = static_cast<std::uint32_t>(std::clamp(std::ceil(sleep.time / time_step), 1.0, 4e9));
  control_ = control;
  const auto n = static_cast<std::size_t>(body_count);
  sleep_timer_.upload(std::vector<std::uint32_t>(n));
  parent_.upload(no_islands(body_count));
  island_active_.resize_discarding(n);
  asleep_.upload(std::vector<std::uint8_t>(n));
  sums_.resize_discarding(reduce_scratch_size(body_count));
}

template <class Real>
void Sleeping<Real>::find_islands(const ContactView<Real>& contacts, std::int64_t contact_capacity,
                                  const JointView<Real>& joints) {
  executor_.run("islands", body_count_, BeginIslands{parent_.data(), island_active_.data(), asleep_.data()});
  const Islands<Real> islands{bodies_, parent_.data(),
                              asleep_.data()};  // asleep_ is scratch until FallAsleepOrWake
  executor_.run("islands", ItemCount(&control_->contacts, contact_capacity),
                JoinByContacts<Real>{contacts.bodies, islands});
  executor_.run("islands", joints.count, JoinByJoints<Real>{joints.rows, islands});
  executor_.run("islands", body_count_,
                MarkActiveIslands{sleep_timer_.data(), steps_to_sleep_, parent_.data(), asleep_.data(),
                                  island_active_.data()});
  executor_.run("islands", body_count_,
                FallAsleepOrWake<Real>{bodies_, parent_.data(), island_active_.data(), sleep_timer_.data(),
                                       asleep_.data(), control_});
}

template <class Real>
void Sleeping<Real>::update_timers() {
  run_awake_bodies(executor_, "islands", body_count_, asleep_.data(),
                   UpdateSleepTimers<Real>{bodies_, speed_, steps_to_sleep_, sleep_timer_.data(), control_});
}

template <class Real>
void Sleeping<Real>::load_warm_start(std::vector<std::uint32_t> sleep_timer) {
  sleep_timer.resize(static_cast<std::size_t>(body_count_), 0);
  sleep_timer_.upload(sleep_timer);
  parent_.upload(no_islands(body_count_));
}

template <class Real>
SleepSums Sleeping<Real>::measure() const {
  SleepSums sums{};
  if (body_count_ == 0) return sums;
  executor_.copy_to_host(
      &sums,
      reduce<SleepSums>(executor_, "measure", body_count_,
                        CountSleepers<Real>{bodies_, parent_.data(), sleep_timer_.data()}, sums_.data()),
      sizeof sums);
  return sums;
}

template class Sleeping<float>;
template class Sleeping<double>;

}  // namespace collidoscope
