#pragma once
// The stages of `soft_step` that prepare contacts: at the start of a step, and after each move. All functors.

#include <cstdint>

#include "sim_cuda/core/whole_record.h"
#include "sim_cuda/solver/colouring.h"
#include "sim_cuda/solver/known_contacts.h"
#include "sim_cuda/solver/soft_memory.h"
#include "sim_cuda/solver/soft_sweeps.h"

namespace collidoscope {

/// Packs what contacts read of each body.
template <class Real>
struct FindBodies {
  Friction<Real> friction;
  GrippedBody<Real>* gripped;  ///< null without friction
  BodyView<Real> bodies;
  FoundBody<Real>* found;
  SIM_HD void operator()(int body) const {
    store_whole(&found[body], FoundBody<Real>{bodies.position[body], bodies.radius[body],
                                              bodies.velocity[body], bodies.inverse_mass[body]});
    if (gripped != nullptr)
      gripped[body] = GrippedBody<Real>::of(bodies, friction, static_cast<std::uint32_t>(body));
  }
};

/// Puts contacts in the order in which they are swept. New ones start from rest, known ones from what they
/// last gave.
template <class Real>
struct PrepareContacts {
  const Pair* contacts;
  const FoundBody<Real>* bodies;
  const GrippedBody<Real>* gripped;  ///< null without friction, as known_grip, grips and turned
  KnownContacts known;
  const Real* known_impulse;
  const Vector3<Real>* known_grip;
  ColourView colours;
  std::uint32_t* place_of;
  Pair* ids_of;
  ContactBodies<Real>* bodies_of;
  Turns* turns;
  StoredContact<Real>* soft;
  GripSums<Real>* grips;
  TurnedBodies<Real>* turned;
  ContactSums<Real>* sums;

  SIM_HD void operator()(int place) const {
    const std::uint32_t contact = colours.order[place];
    const Pair ids = contacts[contact];
    const auto [a, b] = ids;
    place_of[contact] = static_cast<std::uint32_t>(place);
    ids_of[place] = ids;
    const FoundBody<Real> body_a = load_whole(&bodies[a]), body_b = load_whole(&bodies[b]);
    const ContactBodies<Real> of{body_a.inverse_mass, body_b.inverse_mass, body_a.radius, body_b.radius};
    store_whole(&bodies_of[place], of);
    if (colours.colour[place] < Colouring::colours)
      turns[place] = Turns::of(colours.bodies[a].used, colours.bodies[b].used, colours.colour[place]);
    const std::uint32_t before = known.find(a, b);
    const bool found = before != no_pair;
    const Separation<Real> now = of.at(body_a.position, body_b.position);
    SoftContact<Real> k;
    k.normal = now.normal;
    k.gap = now.gap;
    const Real approach = k.meeting_speed(body_b.velocity - body_a.velocity, of.radius_a + of.radius_b);
    sums[place] = {0, approach};
    StoredContact<Real> stored{now.normal, now.gap, found ? known_impulse[before] : Real(0),
                               Vector3<Real>::Zero()};
    if (grips != nullptr) {
      if (found) stored.rubbed = known_grip[before];
      const GrippedBody<Real> grip_a = gripped[a], grip_b = gripped[b];
      store_whole(&grips[place],
                  GripSums<Real>{Vector3<Real>::Zero(),
                                 Friction<Real>::between(grip_a.coefficient, grip_b.coefficient)});
      turned[place] = {grip_a.ease, grip_b.ease};
    }
    store_whole(&soft[place], stored);
  }
};

template <class Real>
struct PlaceContacts {
  const Pair* ids;
  const ContactBodies<Real>* bodies_of;
  const Vector3<Real>* position;
  StoredContact<Real>* soft;
  SIM_HD void operator()(int place) const {
    const auto [a, b] = ids[place];
    StoredContact<Real>::store_face(&soft[place], load_whole(&bodies_of[place]).at(position[a], position[b]));
  }
};

}  // namespace collidoscope
