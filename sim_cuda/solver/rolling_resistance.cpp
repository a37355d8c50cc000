#include "sim_cuda/solver/rolling_resistance.h"

#include <algorithm>

#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/solver/friction.h"

namespace collidoscope {

namespace {

template <class Real>
struct PrepareRolls {
  const Pair* contacts;
  BodyView<Real> bodies;
  RollingLaw<Real> law;
  KnownContacts known;
  const Vector3<Real>* known_impulse;
  Roll<Real>* rolls;

  SIM_HD void operator()(int place) const {
    const auto [a, b] = contacts[place];
    const std::uint32_t before = known.find(a, b);
    const bool found = before != no_pair;
    const Real r_a = bodies.radius[a], r_b = bodies.radius[b];
    rolls[place] = {found ? known_impulse[before] : Vector3<Real>(Vector3<Real>::Zero()),
                    max_of(law.of_body(a), law.of_body(b)) * (r_a * r_b / (r_a + r_b))};
  }
};

/// A body's share of what its contacts give, in increasing id of the other body; `given(place)` in N m s.
template <class Given, class Real>
SIM_HD Vector3<Real> sum_of(const RollingSource<Real>& source, int body, const Given& given) {
  Vector3<Real> sum = Vector3<Real>::Zero();
  const std::uint32_t n = source.by_body.count[body];
  for (std::uint32_t k = 0; k < n; ++k) {
    const ContactEnd end = source.by_body.end(body, k);
    const Vector3<Real> change = given(end.contact);
    if (end.second)
      sum += change;
    else
      sum -= change;
  }
  return sum;
}

template <class Real>
struct WarmRolls {
  RollingSource<Real> source;
  BodyView<Real> bodies;
  std::int64_t body_count;
  int plane_count;
  const Roll<Real>* rolls;
  Vector3<Real>* wall_impulse;
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> moment = Vector3<Real>::Zero();
    if (control->contacts > 0)
      moment = sum_of(source, body, [&](std::uint32_t place) { return rolls[place].impulse; });
    for (int p = 0; p < plane_count; ++p) {
      const std::int64_t at = p * body_count + body;
      if (!(source.wall_impulse[at] > 0)) wall_impulse[at] = Vector3<Real>::Zero();  // it has bounced
      moment += wall_impulse[at];
    }
    if (moment.dot(moment) == 0) return;
    Spin<Real> spin = Spin<Real>::of(bodies, static_cast<std::uint32_t>(body));
    spin.turn(moment);
    bodies.angular_velocity[body] = spin.rate;
  }
};

/// Each contact between its share of the two bodies: one with n contacts counts as n of 1/n of its inertia.
template <class Real>
struct ResistAtContacts {
  RollingSource<Real> source;
  BodyView<Real> bodies;
  Roll<Real>* rolls;
  Vector3<Real>* change;

  SIM_HD void operator()(int place) const {
    const auto [a, b] = source.contacts[place];
    Roll<Real> roll = rolls[place];
    const Real limit = roll.lever * source.soft[place].impulse;
    change[place] = Vector3<Real>::Zero();
    if (!(limit > 0) && roll.impulse.dot(roll.impulse) == 0) return;
    const Real n_a = static_cast<Real>(source.by_body.count[a]),
               n_b = static_cast<Real>(source.by_body.count[b]);
    const Spin<Real> spin_a = Spin<Real>::of(bodies, a), spin_b = Spin<Real>::of(bodies, b);
    const Real inertia = 1 / (n_a * spin_a.ease() + n_b * spin_b.ease());
    change[place] = rub<Real>(spin_b.rate - spin_a.rate, inertia, limit, roll.impulse);
    rolls[place] = roll;
  }
};

/// What its contacts give, and then its planes.
template <class Real>
struct ResistAtBodies {
  RollingSource<Real> source;
  BodyView<Real> bodies;
  std::int64_t body_count;
  int plane_count;
  RollingLaw<Real> law;
  const Vector3<Real>* change;
  Vector3<Real>* wall_impulse;
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    const auto id = static_cast<std::uint32_t>(body);
    Spin<Real> spin = Spin<Real>::of(bodies, id);
    if (control->contacts > 0)
      spin.turn(sum_of(source, body, [&](std::uint32_t place) { return change[place]; }));
    const Real own = law.of_body(id), r = bodies.radius[body];
    for (int p = 0; p < plane_count; ++p) {
      const std::int64_t at = p * body_count + body;
      Vector3<Real> given = wall_impulse[at];
      const Real pressing = source.wall_impulse[at];
      if (!(pressing > 0) && given.dot(given) == 0) continue;
      spin.turn(rub<Real>(spin.rate, 1 / spin.ease(), max_of(own, law.of_plane[p]) * r * pressing, given));
      wall_impulse[at] = given;
    }
    bodies.angular_velocity[body] = spin.rate;
  }
};

template <class Real>
struct KeepRolls {
  const std::uint32_t* place_of;
  const StoredContact<Real>* soft;
  const Roll<Real>* rolls;
  Vector3<Real>* known_impulse;
  SIM_HD void operator()(int contact) const {
    const std::uint32_t place = place_of[contact];
    known_impulse[contact] =
        soft[place].impulse > 0 ? rolls[place].impulse : Vector3<Real>(Vector3<Real>::Zero());
  }
};

template <class Real>
std::vector<std::array<double, 3>> widened(const std::vector<Vector3<Real>>& vectors) {
  std::vector<std::array<double, 3>> wide;
  for (const Vector3<Real>& v : vectors)
    wide.push_back({static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())});
  return wide;
}

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
      rolls_(executor, "rolling resistance of contacts"),
      change_(executor, "changes of rolling resistance"),
      wall_impulse_(executor, "rolling resistance at walls"),
      known_impulse_(executor, "rolling resistance of the last step") {}

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
void RollingResistance<Real>::reserve(std::int64_t contact_capacity, std::size_t known) {
  rolls_.resize_discarding(static_cast<std::size_t>(contact_capacity));
  change_.resize_discarding(static_cast<std::size_t>(contact_capacity));
  known_impulse_.resize_keeping(known);
}

template <class Real>
void RollingResistance<Real>::prepare(const RollingSource<Real>& source, const KnownContacts& known) {
  executor_.run(
      "prepare", source.count,
      PrepareRolls<Real>{source.contacts, bodies_, law_, known, known_impulse_.data(), rolls_.data()});
}

template <class Real>
void RollingResistance<Real>::warm_start(const RollingSource<Real>& source) {
  run_awake_bodies(executor_, "rolling", body_count_, source.asleep,
                   WarmRolls<Real>{source, bodies_, body_count_, plane_count_, rolls_.data(),
                                   wall_impulse_.data(), control_});
}

template <class Real>
void RollingResistance<Real>::resist(const RollingSource<Real>& source) {
  run_awake_contacts(executor_, "rolling", source.count, source.contacts, source.asleep,
                     ResistAtContacts<Real>{source, bodies_, rolls_.data(), change_.data()});
  run_awake_bodies(executor_, "rolling", body_count_, source.asleep,
                   ResistAtBodies<Real>{source, bodies_, body_count_, plane_count_, law_, change_.data(),
                                        wall_impulse_.data(), control_});
}

template <class Real>
void RollingResistance<Real>::keep(const RollingSource<Real>& source) {
  executor_.run("keep", source.count,
                KeepRolls<Real>{source.place_of, source.soft, rolls_.data(), known_impulse_.data()});
}

template <class Real>
void RollingResistance<Real>::memory(std::size_t contacts, SolverMemory& memory) const {
  if (control_ == nullptr) return;
  memory.rolls = widened<Real>(known_impulse_.download(contacts));
  memory.wall_rolls = widened<Real>(wall_impulse_.download());
}

template <class Real>
void RollingResistance<Real>::remember(const SolverMemory& memory, std::size_t contact_capacity) {
  if (control_ == nullptr) return;
  std::vector<Vector3<Real>> known(contact_capacity, Vector3<Real>::Zero()),
      walls(wall_impulse_.size(), Vector3<Real>::Zero());
  narrow<Real>(memory.rolls, known);
  const auto n = static_cast<std::size_t>(body_count_), planes = static_cast<std::size_t>(plane_count_);
  if (memory.walls.size() == planes && !memory.wall_rolls.empty()) {
    const std::size_t bodies = memory.wall_rolls.size() / planes;  // of the other world
    for (std::size_t p = 0; p < planes; ++p)
      for (std::size_t body = 0; body < std::min(n, bodies); ++body)
        for (std::size_t axis = 0; axis < 3; ++axis)
          walls[p * n + body][static_cast<Eigen::Index>(axis)] =
              static_cast<Real>(memory.wall_rolls[p * bodies + body][axis]);
  }
  known_impulse_.upload(known);
  wall_impulse_.upload(walls);
}

template class RollingResistance<float>;
template class RollingResistance<double>;

}  // namespace collidoscope
