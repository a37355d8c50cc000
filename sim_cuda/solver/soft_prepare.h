#pragma once
// Stages of `soft_step` that prepare contacts, at the start of a step and after each move. Functors.

#include <cstdint>

#include "sim_cuda/core/vector_load.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/contact_storage.h"
#include "sim_cuda/solver/previous_contacts.h"
#include "sim_cuda/solver/soft_iteration.h"

namespace collidoscope {

/// Packs the body data that contacts read.
template <class Real>
struct PackBodies {
  Friction<Real> friction;
  BodyFriction<Real>* body_friction;  ///< null without friction
  BodyView<Real> bodies;
  StepBody<Real>* step_bodies;
  SIM_HD void operator()(int body) const {
    store_vectorized(&step_bodies[body], StepBody<Real>{bodies.position[body], bodies.radius[body],
                                                        bodies.velocity[body], bodies.inverse_mass[body]});
    if (body_friction != nullptr)
      body_friction[body] = BodyFriction<Real>::of(bodies, friction, static_cast<std::uint32_t>(body));
  }
};

/// Copies contacts into solve order. Contacts of the previous step start with their cached impulses, new
/// ones with zero.
template <class Real>
struct PrepareContacts {
  const Pair* contacts;
  const StepBody<Real>* bodies;
  const BodyFriction<Real>*
      body_friction;  ///< null without friction, like previous_friction, friction_sums and inertia
  PreviousContacts previous;
  const Real* previous_impulse;
  const Vector3<Real>* previous_friction;
  ColourView colours;
  std::uint32_t* place_of;
  Pair* ids_of;
  ContactBodies<Real>* bodies_of;
  DependencyCounters* dependency_counters;
  PackedContact<Real>* soft;
  FrictionSums<Real>* friction_sums;
  ContactInertia<Real>* inertia;
  ContactSums<Real>* sums;

  SIM_HD void operator()(int place) const {
    const std::uint32_t contact = colours.order[place];
    const Pair ids = contacts[contact];
    const auto [a, b] = ids;
    place_of[contact] = static_cast<std::uint32_t>(place);
    ids_of[place] = ids;
    const auto &body_a = load_readonly(&bodies[a]), &body_b = load_readonly(&bodies[b]);
    const ContactBodies<Real> of{body_a.inverse_mass, body_b.inverse_mass, body_a.radius, body_b.radius};
    store_vectorized(&bodies_of[place], of);
    if (colours.colour[place] < Colouring::colours)
      dependency_counters[place] =
          DependencyCounters::of(colours.bodies[a].used, colours.bodies[b].used, colours.colour[place]);
    const std::uint32_t before = previous.find(a, b);
    const bool found = before != no_pair;
    const Separation<Real> now = of.at(body_a.position, body_b.position);
    PackedContact<Real> stored{now.normal, now.gap, found ? previous_impulse[before] : Real(0),
                               Vector3<Real>::Zero()};
    sums[place] = {0, {stored.impulse > 0 ? ImpactSum<Real>::pressed : Real(0)}};
    if (friction_sums != nullptr) {
      if (found) stored.friction_impulse = previous_friction[before];
      const BodyFriction<Real> friction_a = body_friction[a], friction_b = body_friction[b];
      store_vectorized(
          &friction_sums[place],
          FrictionSums<Real>{Vector3<Real>::Zero(),
                             Friction<Real>::between(friction_a.coefficient, friction_b.coefficient)});
      inertia[place] = {friction_a.inverse_inertia, friction_b.inverse_inertia};
    }
    store_vectorized(&soft[place], stored);
  }
};

/// Updates the normal and the gap of a contact after a move.
template <class Real>
struct UpdateContactGeometry {
  const Pair* ids;
  const ContactBodies<Real>* bodies_of;
  const Vector3<Real>* position;
  PackedContact<Real>* soft;
  SIM_HD void operator()(int place) const {
    const auto [a, b] = ids[place];
    PackedContact<Real>::store_geometry(&soft[place],
                                        load_readonly(&bodies_of[place]).at(position[a], position[b]));
  }
};

/// `jacobi_split`: puts all awake contacts into the mass-split set.
struct SplitAll {
  ColourView colours;
  std::uint32_t* count;
  StepControl* control;
  SIM_HD void operator()(int) const {
    *count = colours.begin[Colouring::colours] + colours.count[Colouring::colours];
    control->uncoloured_contacts = *count;
  }
};

}  // namespace collidoscope
