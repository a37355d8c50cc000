#include "sim_cuda/solver/impulse.h"

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/core/segment_sort.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"

namespace collidoscope {

namespace {

/// The contacts of one colour: no two share a body.
template <class Real, bool push, bool record>
struct ResolveColour {
  ContactView<Real> contacts;
  SolverBodies<Real> bodies;
  Restitution<Real> restitution;
  const std::uint32_t* order;
  const std::uint32_t* begin;
  ImpulseSum<Real, record> impulses;

  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*begin + static_cast<std::uint32_t>(item)];
    const auto [a, b] = contacts.bodies[contact];
    const Vector3<Real> normal = contacts.normal[contact];
    const Real w_a = bodies.inverse_mass[a], w_b = bodies.inverse_mass[b];
    const Vector3<Real> v_a = bodies.velocity[a], v_b = bodies.velocity[b];
    const Real approach = -(v_b - v_a).dot(normal);
    if (approach > 0) {
      const Real e = restitution.between(restitution.of_body(a), restitution.of_body(b), approach);
      const Real impulse = (1 + e) * approach / (w_a + w_b);
      bodies.velocity[a] = v_a - impulse * w_a * normal;
      bodies.velocity[b] = v_b + impulse * w_b * normal;
      impulses.add(contact, impulse);
    }
    if constexpr (push) {
      const Vector3<Real> x_a = bodies.position[a], x_b = bodies.position[b];
      const Real r_a = bodies.radius[a], r_b = bodies.radius[b];
      const Separation<Real> now = separate<Real>(x_a, r_a, x_b, r_b);
      const Real distance = PushRule<Real>::correction(-now.gap, min_of(r_a, r_b));
      if (!(distance > 0)) return;
      const Real share = distance / (w_a + w_b);
      bodies.position[a] = x_a - share * w_a * now.normal;
      bodies.position[b] = x_b + share * w_b * now.normal;
    }
  }
};

template <class Real>
struct ClearImpulses {
  Real* impulse;
  SIM_HD void operator()(int contact) const { impulse[contact] = 0; }
};

// ---- the mass-split set (Tonge, Benevolenski, Voroshilov 2012) ----
//
// A body with n contacts in the set counts as n bodies of 1/n of its mass that all move alike. Each contact
// is resolved between such parts, all at once; then the parts of a body are averaged. Neither resolving nor
// averaging raises the energy.

struct BeginSplit {
  const StepControl* control;
  std::uint32_t bodies;
  std::uint32_t* items;
  SIM_HD void operator()(int) const {
    items[0] = control->split_contacts > 0 ? bodies : 0;
    items[1] = 0;
  }
};

struct ClearSplit {
  std::uint32_t *count, *filled;
  SIM_HD void operator()(int body) const { count[body] = filled[body] = 0; }
};

struct CountSplit {
  const Pair* contacts;
  const std::uint32_t *order, *begin;
  std::uint32_t* count;
  SIM_HD void operator()(int item) const {
    const auto [a, b] = contacts[order[*begin + static_cast<std::uint32_t>(item)]];
    atomic_add(&count[a], 1);
    atomic_add(&count[b], 1);
  }
};

/// Where a body's list stands is free: only its content reaches the state.
struct PlaceSplit {
  const std::uint32_t* count;
  std::uint32_t *handed_out, *begin;
  SIM_HD void operator()(int body) const {
    if (count[body] > 0) begin[body] = atomic_add(handed_out, count[body]);
  }
};

struct FillSplit {
  const Pair* contacts;
  const std::uint32_t *order, *colour_begin, *begin;
  std::uint32_t *filled, *entry;
  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*colour_begin + static_cast<std::uint32_t>(item)];
    const auto [a, b] = contacts[contact];
    entry[begin[a] + atomic_add(&filled[a], 1)] = contact;
    entry[begin[b] + atomic_add(&filled[b], 1)] = contact;
  }
};

/// Contacts are numbered by (a, b), so ascending contact numbers are ascending ids of the other body.
struct SortSplit {
  const std::uint32_t *count, *begin;
  std::uint32_t* entry;
  SIM_HD void operator()(int body) const {
    if (count[body] > 1) sort_segment(entry + begin[body], count[body]);
  }
};

template <class Real, bool push, bool record>
struct ResolveSplit {
  ContactView<Real> contacts;
  SolverBodies<Real> bodies;
  Restitution<Real> restitution;
  const std::uint32_t *order, *begin, *count;
  Real *impulse, *shift;
  ImpulseSum<Real, record> impulses;

  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*begin + static_cast<std::uint32_t>(item)];
    const auto [a, b] = contacts.bodies[contact];
    const Real w = bodies.inverse_mass[a] * static_cast<Real>(count[a]) +
                   bodies.inverse_mass[b] * static_cast<Real>(count[b]);
    const Real approach = -(bodies.velocity[b] - bodies.velocity[a]).dot(contacts.normal[contact]);
    const Real e = restitution.between(restitution.of_body(a), restitution.of_body(b), approach);
    impulse[contact] = approach > 0 ? (1 + e) * approach / w : Real(0);
    impulses.add(contact, impulse[contact]);
    if constexpr (push) {
      const Real r_a = bodies.radius[a], r_b = bodies.radius[b];
      const Real gap = separate<Real>(bodies.position[a], r_a, bodies.position[b], r_b).gap;
      shift[contact] = PushRule<Real>::correction(-gap, min_of(r_a, r_b)) / w;
    }
  }
};

/// A body's share of all its contacts in the set, added in increasing id of the other body.
template <class Real, bool push>
struct ApplySplit {
  ContactView<Real> contacts;
  SolverBodies<Real> bodies;
  const std::uint32_t *count, *begin, *entry;
  const Real *impulse, *shift;

  SIM_HD void operator()(int body) const {
    const std::uint32_t n = count[body];
    if (n == 0) return;
    Vector3<Real> momentum = Vector3<Real>::Zero(), moved = Vector3<Real>::Zero();
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t contact = entry[begin[body] + k];
      const Real sign = contacts.bodies[contact].a == static_cast<std::uint32_t>(body) ? Real(-1) : Real(1);
      const Vector3<Real> normal = contacts.normal[contact];
      momentum += sign * impulse[contact] * normal;
      if constexpr (push) moved += sign * shift[contact] * normal;
    }
    bodies.velocity[body] += bodies.inverse_mass[body] * momentum;
    if constexpr (push) bodies.position[body] += bodies.inverse_mass[body] * moved;
  }
};

}  // namespace

template <class Real>
ImpulseSolver<Real>::ImpulseSolver(Executor& executor)
    : executor_(executor),
      colouring_(executor),
      split_items_(executor, "split set size"),
      split_count_(executor, "split contacts per body"),
      split_filled_(executor, "split contacts filled"),
      split_begin_(executor, "split list starts"),
      split_entry_(executor, "split lists"),
      split_impulse_(executor, "split impulses"),
      split_push_(executor, "split pushes") {}

template <class Real>
void ImpulseSolver<Real>::reserve(std::int64_t bodies, std::int64_t contact_capacity) {
  bodies_ = bodies;
  contact_capacity_ = contact_capacity;
  colouring_.reserve(bodies, contact_capacity);
  const auto n = static_cast<std::size_t>(bodies), m = static_cast<std::size_t>(contact_capacity);
  split_items_.resize_discarding(2);
  split_count_.resize_discarding(n);
  split_filled_.resize_discarding(n);
  split_begin_.resize_discarding(n);
  split_entry_.resize_discarding(2 * m);
  split_impulse_.resize_discarding(m);
  split_push_.resize_discarding(m);
}

template <class Real>
void ImpulseSolver<Real>::solve(const ContactView<Real>& contacts, const SolverBodies<Real>& bodies,
                                const Restitution<Real>& restitution, int iterations, Real* impulses,
                                StepControl* control) {
  colouring_.colour(contacts.bodies, control);
  list_split(contacts, control);
  if (impulses != nullptr)
    executor_.run("solve", Count(&control->contacts, contact_capacity_), ClearImpulses<Real>{impulses});
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const bool push = iteration + 1 == iterations;
    if (impulses != nullptr)
      push ? sweep<true, true>(contacts, bodies, restitution, {impulses}, control)
           : sweep<false, true>(contacts, bodies, restitution, {impulses}, control);
    else
      push ? sweep<true, false>(contacts, bodies, restitution, {}, control)
           : sweep<false, false>(contacts, bodies, restitution, {}, control);
  }
}

template <class Real>
void ImpulseSolver<Real>::list_split(const ContactView<Real>& contacts, StepControl* control) {
  const ColourView colours = colouring_.view();
  const std::uint32_t* split_begin = colours.begin + Colouring::colours;
  const Count split_contacts(&control->split_contacts, contact_capacity_);
  const Count split_bodies(split_items_.data(), bodies_);
  executor_.run("solve", 1, BeginSplit{control, static_cast<std::uint32_t>(bodies_), split_items_.data()});
  executor_.run("solve", split_bodies, ClearSplit{split_count_.data(), split_filled_.data()});
  executor_.run("solve", split_contacts,
                CountSplit{contacts.bodies, colours.order, split_begin, split_count_.data()});
  executor_.run("solve", split_bodies,
                PlaceSplit{split_count_.data(), split_items_.data() + 1, split_begin_.data()});
  executor_.run("solve", split_contacts,
                FillSplit{contacts.bodies, colours.order, split_begin, split_begin_.data(),
                          split_filled_.data(), split_entry_.data()});
  executor_.run("solve", split_bodies,
                SortSplit{split_count_.data(), split_begin_.data(), split_entry_.data()});
}

template <class Real>
template <bool push, bool record>
void ImpulseSolver<Real>::sweep(const ContactView<Real>& contacts, const SolverBodies<Real>& bodies,
                                const Restitution<Real>& restitution,
                                const ImpulseSum<Real, record>& impulses, const StepControl* control) {
  const ColourView colours = colouring_.view();
  // Contacts of one colour share no body, so there are at most half as many as bodies.
  const std::int64_t colour_capacity = contact_capacity_ < bodies_ / 2 ? contact_capacity_ : bodies_ / 2;
  for (int c = 0; c < Colouring::colours; ++c)
    executor_.run("solve", Count(colours.count + c, colour_capacity),
                  ResolveColour<Real, push, record>{contacts, bodies, restitution, colours.order,
                                                    colours.begin + c, impulses});
  executor_.run("solve", Count(&control->split_contacts, contact_capacity_),
                ResolveSplit<Real, push, record>{contacts, bodies, restitution, colours.order,
                                                 colours.begin + Colouring::colours, split_count_.data(),
                                                 split_impulse_.data(), split_push_.data(), impulses});
  executor_.run("solve", Count(split_items_.data(), bodies_),
                ApplySplit<Real, push>{contacts, bodies, split_count_.data(), split_begin_.data(),
                                       split_entry_.data(), split_impulse_.data(), split_push_.data()});
}

template class ImpulseSolver<float>;
template class ImpulseSolver<double>;

}  // namespace collidoscope
