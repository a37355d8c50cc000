#include "sim_cuda/solver/soft_step.h"

#include <algorithm>

#include "sim_cuda/dynamics/move.h"

namespace collidoscope {

namespace {

/// New contacts start from rest, known ones from what they last gave.
template <class Real>
struct PrepareContacts {
  const Pair* contacts;
  BodyView<Real> bodies;
  ImpulseView<Real> known;
  SoftContact<Real>* soft;
  SIM_HD void operator()(int contact) const {
    const auto [a, b] = contacts[contact];
    SoftContact<Real> k;
    k.place(bodies, a, b);
    k.impulse = known.of(a, b);
    k.total = 0;
    k.approach =
        k.meeting_speed(bodies.velocity[b] - bodies.velocity[a], bodies.radius[a] + bodies.radius[b]);
    k.radius = min_of(bodies.radius[a], bodies.radius[b]);
    soft[contact] = k;
  }
};

template <class Real>
struct PlaceContacts {
  const Pair* contacts;
  BodyView<Real> bodies;
  SoftContact<Real>* soft;
  SIM_HD void operator()(int contact) const {
    soft[contact].place(bodies, contacts[contact].a, contacts[contact].b);
  }
};

/// Forces, the impulses of the substep before, and the first sweep over the planes.
template <class Real, bool pulled, bool walled>
struct BeginSubstep {
  BodyView<Real> bodies;
  const Pair* contacts;
  const SoftContact<Real>* soft;
  ContactsByBodyView by_body;
  SoftWalls<Real> walls;
  Vector3<Real> gravity;  ///< m/s^2
  Real h;                 ///< s
  const StepControl* control;

  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    const Vector3<Real> before = bodies.velocity[id];
    Vector3<Real> v = before;
    if constexpr (pulled) v += h * gravity;
    const std::uint32_t n = control->contacts > 0 ? by_body.count[id] : 0;
    const Real w = bodies.inverse_mass[id];
    [[maybe_unused]] typename SoftWalls<Real>::Body body;
    if constexpr (walled) {
      body = {bodies.position[id], v, bodies.radius[id], bodies.mass[id], w};
      walls.warm_start(id, body);
      v = body.v;
    }
    if (n > 0) {
      Vector3<Real> momentum = Vector3<Real>::Zero();
      for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t contact = by_body.entry[by_body.begin[id] + k];
        const Real sign = contacts[contact].a == static_cast<std::uint32_t>(id) ? Real(-1) : Real(1);
        momentum += sign * soft[contact].impulse * soft[contact].normal;
      }
      v += w * momentum;
    }
    if constexpr (walled) {
      body.v = v;
      walls.solve(id, body, false, &before);
      v = body.v;
      if (body.moved) bodies.position[id] = body.x;
    }
    bodies.velocity[id] = v;
  }
};

// What a sweep does with one contact between bodies a and b, of which b moves at `velocity` relative to a and
// `mass`, in kg, is what it works against; returns the impulse, N s.

template <class Real>
struct Solve {
  Softness<Real> softness;
  SIM_HD Real operator()(SoftContact<Real>& contact, Pair, const Vector3<Real>& velocity, Real mass) const {
    return contact.template solve<true>(velocity.dot(contact.normal), mass, softness);
  }
};

template <class Real>
struct Relax {
  Softness<Real> softness;
  const Real* radius;
  bool last;  ///< of the sweeps of this substep
  SIM_HD Real operator()(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity,
                         Real mass) const {
    const Real change = contact.template solve<false>(velocity.dot(contact.normal), mass, softness);
    if (last) contact.end_substep(velocity, radius[bodies.a] + radius[bodies.b]);
    return change;
  }
};

template <class Real>
struct Bounce {
  Restitution<Real> restitution;
  SIM_HD Real operator()(SoftContact<Real>& contact, Pair bodies, const Vector3<Real>& velocity,
                         Real mass) const {
    const Real e =
        restitution.between(restitution.of_body(bodies.a), restitution.of_body(bodies.b), contact.approach);
    return contact.bounce(velocity.dot(contact.normal), mass, e);
  }
};

/// The contacts of one colour: no two share a body.
template <class Real, class Act>
struct SweepColour {
  const Pair* contacts;
  SoftContact<Real>* soft;
  BodyView<Real> bodies;
  const std::uint32_t *order, *begin;
  Act act;
  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*begin + static_cast<std::uint32_t>(item)];
    const auto [a, b] = contacts[contact];
    SoftContact<Real> k = soft[contact];
    const Real w_a = bodies.inverse_mass[a], w_b = bodies.inverse_mass[b];
    const Vector3<Real> v_a = bodies.velocity[a], v_b = bodies.velocity[b];
    const Real change = act(k, {a, b}, v_b - v_a, 1 / (w_a + w_b));
    soft[contact] = k;
    if (change == 0) return;
    bodies.velocity[a] = v_a - change * w_a * k.normal;
    bodies.velocity[b] = v_b + change * w_b * k.normal;
  }
};

/// The mass-split set (Tonge, Benevolenski, Voroshilov 2012): a body with n contacts in it counts as n bodies
/// of 1/n of its mass, whose velocities are averaged afterwards.
template <class Real, class Act>
struct SweepSplit {
  const Pair* contacts;
  SoftContact<Real>* soft;
  BodyView<Real> bodies;
  const std::uint32_t *order, *begin, *count;
  Real* split_change;
  Act act;
  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*begin + static_cast<std::uint32_t>(item)];
    const auto [a, b] = contacts[contact];
    const Real w = bodies.inverse_mass[a] * static_cast<Real>(count[a]) +
                   bodies.inverse_mass[b] * static_cast<Real>(count[b]);
    split_change[contact] = act(soft[contact], {a, b}, bodies.velocity[b] - bodies.velocity[a], 1 / w);
  }
};

/// A body's share of all its contacts in the set, added in increasing id of the other body.
template <class Real>
struct ApplySplit {
  const Pair* contacts;
  const SoftContact<Real>* soft;
  BodyView<Real> bodies;
  ContactsByBodyView split;
  const Real* split_change;
  SIM_HD void operator()(int body) const {
    const std::uint32_t n = split.count[body];
    if (n == 0) return;
    Vector3<Real> momentum = Vector3<Real>::Zero();
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t contact = split.entry[split.begin[body] + k];
      const Real sign = contacts[contact].a == static_cast<std::uint32_t>(body) ? Real(-1) : Real(1);
      momentum += sign * split_change[contact] * soft[contact].normal;
    }
    bodies.velocity[body] += bodies.inverse_mass[body] * momentum;
  }
};

template <class Real, bool record>
struct KeepContacts {
  const Pair* contacts;
  const SoftContact<Real>* soft;
  Pair* known_contacts;
  Real* known_impulse;
  Real* total;
  SIM_HD void operator()(int contact) const {
    known_contacts[contact] = contacts[contact];
    known_impulse[contact] = soft[contact].impulse;
    if constexpr (record) total[contact] = soft[contact].total;
  }
};

struct KeepCount {
  const StepControl* control;
  std::uint32_t* count;
  SIM_HD void operator()(int) const {
    if (!control->overflow) *count = control->contacts;
  }
};

}  // namespace

template <class Real>
SoftStepSolver<Real>::SoftStepSolver(Executor& executor, const SolverScene<Real>& scene)
    : executor_(executor),
      scene_(scene),
      h_(scene.time_step / static_cast<Real>(scene.substeps)),
      softness_(Softness<Real>::of(h_)),
      colouring_(executor),
      all_(executor),
      split_(executor),
      soft_(executor, "contacts of the solver"),
      split_change_(executor, "split impulses"),
      wall_impulse_(executor, "impulses of walls"),
      wall_bounce_(executor, "bounces off walls"),
      known_contacts_(executor, "contacts of the last step"),
      known_impulse_(executor, "impulses of the last step"),
      known_count_(executor, "number of contacts of the last step") {
  const auto walls = static_cast<std::size_t>(scene.plane_count) * static_cast<std::size_t>(scene.body_count);
  wall_impulse_.upload(std::vector<Real>(walls, 0));
  wall_bounce_.upload(std::vector<Real>(walls, -1));
  known_count_.upload({0});
}

template <class Real>
void SoftStepSolver<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  const auto m = static_cast<std::size_t>(contact_capacity);
  colouring_.reserve(scene_.body_count, contact_capacity);
  all_.reserve(scene_.body_count, contact_capacity);
  split_.reserve(scene_.body_count, contact_capacity);
  soft_.resize_discarding(m);
  split_change_.resize_discarding(m);
  known_contacts_.resize_keeping(std::max(m, remembered_));
  known_impulse_.resize_keeping(std::max(m, remembered_));
}

template <class Real>
SolverMemory SoftStepSolver<Real>::memory() const {
  SolverMemory memory;
  const std::size_t count = known_count_.download()[0];
  const std::vector<Pair> contacts = known_contacts_.download(count);
  const std::vector<Real> impulse = known_impulse_.download(count);
  for (std::size_t k = 0; k < count; ++k)
    memory.contacts.push_back({contacts[k].a, contacts[k].b, static_cast<double>(impulse[k])});
  const std::vector<Real> walls = wall_impulse_.download();
  for (auto plane = walls.begin(); plane != walls.end(); plane += scene_.body_count)
    memory.walls.emplace_back(plane, plane + scene_.body_count);
  return memory;
}

template <class Real>
void SoftStepSolver<Real>::remember(const SolverMemory& memory) {
  remembered_ = memory.contacts.size();
  const auto m = std::max(static_cast<std::size_t>(contact_capacity_), remembered_);
  std::vector<Pair> contacts(m);
  std::vector<Real> impulse(m);
  for (std::size_t k = 0; k < remembered_; ++k) {
    contacts[k] = {memory.contacts[k].a, memory.contacts[k].b};
    impulse[k] = static_cast<Real>(memory.contacts[k].impulse);
  }
  known_contacts_.upload(contacts);
  known_impulse_.upload(impulse);
  known_count_.upload({static_cast<std::uint32_t>(remembered_)});
  if (memory.walls.size() != static_cast<std::size_t>(scene_.plane_count)) return;
  std::vector<Real> walls;
  for (const std::vector<double>& plane : memory.walls)
    for (std::size_t body = 0; body < static_cast<std::size_t>(scene_.body_count); ++body)
      walls.push_back(body < plane.size() ? static_cast<Real>(plane[body]) : Real(0));
  wall_impulse_.upload(walls);
}

template <class Real>
void SoftStepSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  StepControl* control = scene_.control;
  colouring_.colour(contacts.bodies, control);
  const ColourView colours = colouring_.view();
  all_.list("prepare", contacts.bodies, colours.order, colours.begin, &control->contacts);
  split_.list("prepare", contacts.bodies, colours.order, colours.begin + Colouring::colours,
              &control->split_contacts);
  const Count contact_count(&control->contacts, contact_capacity_);
  executor_.run("prepare", contact_count,
                PrepareContacts<Real>{contacts.bodies,
                                      scene_.bodies,
                                      {known_contacts_.data(), known_impulse_.data(), known_count_.data()},
                                      soft_.data()});
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    begin_substep(contacts);
    for (int sweeps = 0; sweeps < scene_.iterations; ++sweeps) {
      sweep<Solve>("solve", contacts, softness_);
      sweep_walls("solve", false);
    }
    move_bodies<Real>(executor_, scene_.bodies, scene_.body_count, {.rotation = scene_.effects.rotation},
                      scene_.gravity, scene_.box, h_, control);
    executor_.run("relax", contact_count, PlaceContacts<Real>{contacts.bodies, scene_.bodies, soft_.data()});
    for (int sweeps = 1; sweeps <= scene_.iterations; ++sweeps) {
      sweep_walls("relax", true);
      sweep<Relax>("relax", contacts, softness_, scene_.bodies.radius, sweeps == scene_.iterations);
    }
  }
  if (scene_.plane_count > 0)
    executor_.run("bounce", scene_.body_count, BounceOffWalls<Real>{walls(), control});
  sweep<Bounce>("bounce", contacts, scene_.restitution);
  if (impulses != nullptr)
    executor_.run("keep", contact_count,
                  KeepContacts<Real, true>{contacts.bodies, soft_.data(), known_contacts_.data(),
                                           known_impulse_.data(), impulses});
  else
    executor_.run("keep", contact_count,
                  KeepContacts<Real, false>{contacts.bodies, soft_.data(), known_contacts_.data(),
                                            known_impulse_.data(), nullptr});
  executor_.run("keep", 1, KeepCount{control, known_count_.data()});
}

template <class Real>
void SoftStepSolver<Real>::begin_substep(const ContactView<Real>& contacts) {
  const auto with = [&]<bool pulled, bool walled>() {
    executor_.run(
        "forces", scene_.body_count,
        BeginSubstep<Real, pulled, walled>{scene_.bodies, contacts.bodies, soft_.data(), all_.view(), walls(),
                                           scene_.gravity, h_, scene_.control});
  };
  const bool walled = scene_.plane_count > 0;
  if (scene_.effects.gravity)
    walled ? with.template operator()<true, true>() : with.template operator()<true, false>();
  else
    walled ? with.template operator()<false, true>() : with.template operator()<false, false>();
}

template <class Real>
template <template <class> class Act, class... Parameters>
void SoftStepSolver<Real>::sweep(const char* stage, const ContactView<Real>& contacts,
                                 const Parameters&... parameters) {
  const Act<Real> act{parameters...};
  const ColourView colours = colouring_.view();
  const ContactsByBodyView split = split_.view();
  // Contacts of one colour share no body, so there are at most half as many as bodies.
  const std::int64_t colour_capacity =
      contact_capacity_ < scene_.body_count / 2 ? contact_capacity_ : scene_.body_count / 2;
  for (int c = 0; c < Colouring::colours; ++c)
    executor_.run(stage, Count(colours.count + c, colour_capacity),
                  SweepColour<Real, Act<Real>>{contacts.bodies, soft_.data(), scene_.bodies, colours.order,
                                               colours.begin + c, act});
  executor_.run(stage, Count(&scene_.control->split_contacts, contact_capacity_),
                SweepSplit<Real, Act<Real>>{contacts.bodies, soft_.data(), scene_.bodies, colours.order,
                                            colours.begin + Colouring::colours, split.count,
                                            split_change_.data(), act});
  executor_.run(stage, split_.bodies(),
                ApplySplit<Real>{contacts.bodies, soft_.data(), scene_.bodies, split, split_change_.data()});
}

template <class Real>
SoftWalls<Real> SoftStepSolver<Real>::walls() const {
  return {scene_.bodies,  scene_.body_count,   scene_.planes,        scene_.plane_count,  scene_.restitution,
          scene_.gravity, softness_.inverse_h, wall_impulse_.data(), wall_bounce_.data(), scene_.ledger};
}

template <class Real>
void SoftStepSolver<Real>::sweep_walls(const char* stage, bool relaxing) {
  if (scene_.plane_count > 0)
    executor_.run(stage, scene_.body_count, SolveWalls<Real>{walls(), relaxing, scene_.control});
}

template class SoftStepSolver<float>;
template class SoftStepSolver<double>;

}  // namespace collidoscope
