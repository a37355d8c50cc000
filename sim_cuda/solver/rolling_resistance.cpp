#include "sim_cuda/solver/rolling_resistance.h"

#include <algorithm>

#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/wide_vectors.h"

namespace collidoscope {

namespace {

template <class Real>
struct PrepareRolling {
  const Pair* contacts;
  BodyView<Real> bodies;
  RollingLaw<Real> law;
  PreviousContacts previous;
  const Vector3<Real>* previous_impulse;
  RollingImpulse<Real>* rolling;

  SIM_HD void operator()(int place) const {
    const auto [a, b] = contacts[place];
    const std::uint32_t before = previous.find(a, b);
    const bool found = before != no_pair;
    const Real r_a = bodies.radius[a], r_b = bodies.radius[b];
    rolling[place] = {found ? previous_impulse[before] : Vector3<Real>(Vector3<Real>::Zero()),
                      max_of(law.of_body(a), law.of_body(b)) * (r_a * r_b / (r_a + r_b))};
  }
};

/// Sum over the contacts of a body, in increasing id of the other body, with the sign of its end.
/// `impulse_of(place)`: N m s.
template <class ImpulseOf, class Real>
SIM_HD Vector3<Real> sum_of(const RollingSource<Real>& source, int body, const ImpulseOf& impulse_of) {
  Vector3<Real> sum = Vector3<Real>::Zero();
  const std::uint32_t n = source.by_body.count[body];
  for (std::uint32_t k = 0; k < n; ++k) {
    const ContactEnd end = source.by_body.end(body, k);
    const Vector3<Real> change = impulse_of(end.contact);
    if (end.second)
      sum += change;
    else
      sum -= change;
  }
  return sum;
}

template <class Real>
struct WarmStartRolling {
  RollingSource<Real> source;
  BodyView<Real> bodies;
  std::int64_t body_count;
  int plane_count;
  const RollingImpulse<Real>* rolling;
  Vector3<Real>* wall_impulse;
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> moment = Vector3<Real>::Zero();
    if (control->contacts > 0)
      moment = sum_of(source, body, [&](std::uint32_t place) { return rolling[place].impulse; });
    for (int p = 0; p < plane_count; ++p) {
      const std::int64_t at = p * body_count + body;
      if (!(source.wall_impulse[at] > 0))
        wall_impulse[at] = Vector3<Real>::Zero();  // reset: no contact, or bounced
      moment += wall_impulse[at];
    }
    if (moment.dot(moment) == 0) return;
    AngularState<Real> angular = AngularState<Real>::of(bodies, static_cast<std::uint32_t>(body));
    angular.apply_angular_impulse(moment);
    bodies.angular_velocity[body] = angular.velocity;
  }
};

/// Solves each contact between parts of its bodies. A body with n contacts is split into n parts of 1/n of
/// its inertia.
template <class Real>
struct SolveRollingContacts {
  RollingSource<Real> source;
  BodyView<Real> bodies;
  RollingImpulse<Real>* rolling;
  Vector3<Real>* change;

  SIM_HD void operator()(int place) const {
    const auto [a, b] = source.contacts[place];
    RollingImpulse<Real> rolling_impulse = rolling[place];
    const Real limit = rolling_impulse.lever * source.soft[place].impulse;
    change[place] = Vector3<Real>::Zero();
    if (!(limit > 0) && rolling_impulse.impulse.dot(rolling_impulse.impulse) == 0) return;
    const Real n_a = static_cast<Real>(source.by_body.count[a]),
               n_b = static_cast<Real>(source.by_body.count[b]);
    const AngularState<Real> angular_a = AngularState<Real>::of(bodies, a),
                             angular_b = AngularState<Real>::of(bodies, b);
    const Vector3<Real> velocity = angular_b.velocity - angular_a.velocity;
    const Real inverse_inertia =
        n_a * angular_a.inverse_inertia_along(velocity) + n_b * angular_b.inverse_inertia_along(velocity);
    if (!(inverse_inertia > 0)) return;  // frozen bodies keep their impulses
    change[place] = solve_friction<Real>(velocity, 1 / inverse_inertia, limit, rolling_impulse.impulse);
    rolling[place] = rolling_impulse;
  }
};

/// Applies the changes of a body's contacts, then solves its planes.
template <class Real>
struct SolveRollingBodies {
  RollingSource<Real> source;
  BodyView<Real> bodies;
  std::int64_t body_count;
  int plane_count;
  RollingLaw<Real> law;
  const Vector3<Real>* change;
  Vector3<Real>* wall_impulse;
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow || !(bodies.inverse_mass[body] > 0)) return;  // frozen bodies keep their impulses
    const auto id = static_cast<std::uint32_t>(body);
    AngularState<Real> angular = AngularState<Real>::of(bodies, id);
    if (control->contacts > 0)
      angular.apply_angular_impulse(sum_of(source, body, [&](std::uint32_t place) { return change[place]; }));
    const Real own = law.of_body(id), r = bodies.radius[body];
    for (int p = 0; p < plane_count; ++p) {
      const std::int64_t at = p * body_count + body;
      Vector3<Real> accumulated = wall_impulse[at];
      const Real normal_impulse = source.wall_impulse[at];
      if (!(normal_impulse > 0) && accumulated.dot(accumulated) == 0) continue;
      angular.apply_angular_impulse(
          solve_friction<Real>(angular.velocity, 1 / angular.inverse_inertia_along(angular.velocity),
                               max_of(own, law.of_plane[p]) * r * normal_impulse, accumulated));
      wall_impulse[at] = accumulated;
    }
    bodies.angular_velocity[body] = angular.velocity;
  }
};

template <class Real>
struct StoreRollingImpulses {
  const std::uint32_t* place_of;
  const PackedContact<Real>* soft;
  const RollingImpulse<Real>* rolling;
  Vector3<Real>* previous_impulse;
  SIM_HD void operator()(int contact) const {
    const std::uint32_t place = place_of[contact];
    previous_impulse[contact] =
        soft[place].impulse > 0 ? rolling[place].impulse : Vector3<Real>(Vector3<Real>::Zero());
  }
};

template <class Real>
void narrow(const std::vector<std::array<double, 3>>& wide, std::vector<Vector3<Real>>& narrow) {
  for (std::size_t k = 0; k < std::min(wide.size(), narrow.size()); ++k)
    for (int axis = 0; axis < 3; ++axis)
      narrow[k][axis] = static_cast<Real>(wide[k][static_cast<std::size_t>(axis)]);
}

}  // namespace

template <class Real>
RollingResistance<Real>::RollingResistance(Executor& executor)
    : executor_(executor),
      rolling_impulses_(executor, "contact rolling resistance"),
      change_(executor, "rolling resistance changes"),
      wall_impulse_(executor, "wall rolling resistance"),
      previous_impulse_(executor, "previous rolling resistance") {}

template <class Real>
void RollingResistance<Real>::enable(const BodyView<Real>& bodies, std::int64_t body_count, int plane_count,
                                     const RollingLaw<Real>& law, const StepControl* control) {
  bodies_ = bodies;
  body_count_ = body_count;
  plane_count_ = plane_count;
  law_ = law;
  control_ = control;
  wall_impulse_.upload(std::vector<Vector3<Real>>(
      static_cast<std::size_t>(plane_count) * static_cast<std::size_t>(body_count), Vector3<Real>::Zero()));
}

template <class Real>
void RollingResistance<Real>::reserve(std::int64_t contact_capacity, std::size_t previous) {
  rolling_impulses_.resize_discarding(static_cast<std::size_t>(contact_capacity));
  change_.resize_discarding(static_cast<std::size_t>(contact_capacity));
  previous_impulse_.resize_keeping(previous);
}

template <class Real>
void RollingResistance<Real>::prepare(const RollingSource<Real>& source, const PreviousContacts& previous) {
  executor_.run("prepare", source.count,
                PrepareRolling<Real>{source.contacts, bodies_, law_, previous, previous_impulse_.data(),
                                     rolling_impulses_.data()});
}

template <class Real>
void RollingResistance<Real>::warm_start(const RollingSource<Real>& source) {
  run_awake_bodies(executor_, "rolling", body_count_, source.asleep,
                   WarmStartRolling<Real>{source, bodies_, body_count_, plane_count_,
                                          rolling_impulses_.data(), wall_impulse_.data(), control_});
}

template <class Real>
void RollingResistance<Real>::solve(const RollingSource<Real>& source) {
  run_awake_contacts(executor_, "rolling", source.count, source.contacts, source.asleep,
                     SolveRollingContacts<Real>{source, bodies_, rolling_impulses_.data(), change_.data()});
  run_awake_bodies(executor_, "rolling", body_count_, source.asleep,
                   SolveRollingBodies<Real>{source, bodies_, body_count_, plane_count_, law_, change_.data(),
                                            wall_impulse_.data(), control_});
}

template <class Real>
void RollingResistance<Real>::store_impulses(const RollingSource<Real>& source) {
  executor_.run("keep", source.count,
                StoreRollingImpulses<Real>{source.place_of, source.soft, rolling_impulses_.data(),
                                           previous_impulse_.data()});
}

template <class Real>
void RollingResistance<Real>::save_warm_start(std::size_t contacts, WarmStartParts& parts) const {
  if (control_ == nullptr) return;
  parts.add([rolling = previous_impulse_.download(contacts),
             walls = wall_impulse_.download()](WarmStart& warm_start) {
    warm_start.rolling = widened_vectors<Real>(rolling, rolling.size());
    warm_start.wall_rolling = widened_vectors<Real>(walls, walls.size());
  });
}

template <class Real>
void RollingResistance<Real>::load_warm_start(const WarmStart& warm_start, std::size_t contact_capacity) {
  if (control_ == nullptr) return;
  std::vector<Vector3<Real>> previous(contact_capacity, Vector3<Real>::Zero()),
      walls(wall_impulse_.size(), Vector3<Real>::Zero());
  narrow<Real>(warm_start.rolling, previous);
  const auto n = static_cast<std::size_t>(body_count_), planes = static_cast<std::size_t>(plane_count_);
  if (warm_start.walls.size() == planes && !warm_start.wall_rolling.empty()) {
    const std::size_t bodies = warm_start.wall_rolling.size() / planes;  // of the loaded state
    for (std::size_t p = 0; p < planes; ++p)
      for (std::size_t body = 0; body < std::min(n, bodies); ++body)
        for (std::size_t axis = 0; axis < 3; ++axis)
          walls[p * n + body][static_cast<Eigen::Index>(axis)] =
              static_cast<Real>(warm_start.wall_rolling[p * bodies + body][axis]);
  }
  previous_impulse_.upload(previous);
  wall_impulse_.upload(walls);
}

template class RollingResistance<float>;
template class RollingResistance<double>;

}  // namespace collidoscope
