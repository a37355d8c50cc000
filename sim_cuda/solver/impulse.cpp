#include "sim_cuda/solver/impulse.h"

#include "sim_cuda/core/block.h"
#include "sim_cuda/core/ordered_sums.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"

namespace collidoscope {

namespace {

/// Adds the potential energy of a body that is pushed by `shift` m to push_work.
template <class Real>
struct PushWork {
  Vector3<Real> gravity;           ///< m/s^2
  StaticImpulse* static_impulses;  ///< null without gravity and walls
  SIM_HD void add(const BodyView<Real>& bodies, std::uint32_t body, const Vector3<Real>& shift) const {
    if (static_impulses != nullptr && bodies.inverse_mass[body] > 0)
      static_impulses[body].push_work -= static_cast<double>(bodies.mass[body] * gravity.dot(shift));
  }
};

/// Resolves one contact. The contacts of a launch have one colour, so no two share a body.
template <class Real>
struct ResolveContact {
  ContactView<Real> contacts;
  BodyView<Real> bodies;
  Restitution<Real> restitution;
  ImpulseSum<Real> impulses;
  bool correct_positions;  ///< also push overlapping bodies apart
  PushWork<Real> work;

  SIM_HD void operator()(int contact) const {
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
    if (correct_positions) {
      const Vector3<Real> x_a = bodies.position[a], x_b = bodies.position[b];
      const Real r_a = bodies.radius[a], r_b = bodies.radius[b];
      const Separation<Real> now = separate<Real>(x_a, r_a, x_b, r_b);
      const Real distance = PositionCorrection<Real>::distance(-now.gap, min_of(r_a, r_b));
      if (!(distance > 0)) return;
      const Real share = distance / (w_a + w_b);
      bodies.position[a] = x_a - share * w_a * now.normal;
      bodies.position[b] = x_b + share * w_b * now.normal;
      if (w_a > 0 && w_b > 0) return;  // the sum of their potential energies stays the same
      work.add(bodies, a, -share * w_a * now.normal);
      work.add(bodies, b, share * w_b * now.normal);
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
// A body with n contacts in the set is split into n equal parts of 1/n of its mass. Each contact is
// resolved between two parts, all contacts in parallel. Then the parts of each body are averaged. Neither
// step raises the energy.

template <class Real>
struct ResolveUncoloured {
  ContactView<Real> contacts;
  BodyView<Real> bodies;
  Restitution<Real> restitution;
  const std::uint32_t *order, *begin, *count;
  Real *impulse, *shift;
  ImpulseSum<Real> impulses;
  bool correct_positions;  ///< also push overlapping bodies apart

  SIM_HD void operator()(int item) const {
    const std::uint32_t contact = order[*begin + static_cast<std::uint32_t>(item)];
    const auto [a, b] = contacts.bodies[contact];
    const Real w = bodies.inverse_mass[a] * static_cast<Real>(count[a]) +
                   bodies.inverse_mass[b] * static_cast<Real>(count[b]);
    const Real approach =
        -(bodies.velocity[b].load() - bodies.velocity[a].load()).dot(contacts.normal[contact]);
    const Real e = restitution.between(restitution.of_body(a), restitution.of_body(b), approach);
    impulse[contact] = approach > 0 ? (1 + e) * approach / w : Real(0);
    impulses.add(contact, impulse[contact]);
    if (correct_positions) {
      const Real r_a = bodies.radius[a], r_b = bodies.radius[b];
      const Real gap = separate<Real>(bodies.position[a], r_a, bodies.position[b], r_b).gap;
      shift[contact] = PositionCorrection<Real>::distance(-gap, min_of(r_a, r_b)) / w;
    }
  }
};

/// Applies the impulses of a body's contacts in the set, summed in increasing id of the other body.
template <class Real>
struct ApplyUncoloured {
  ContactView<Real> contacts;
  BodyView<Real> bodies;
  ContactsByBodyView uncoloured;
  const Real *impulse, *shift;
  bool correct_positions;
  PushWork<Real> work;

  SIM_HD void operator()(int body) const {
    const std::uint32_t n = uncoloured.count[body];
    if (n > 0) apply(body, ImpulseSums::accumulate(n, entry(body)));
  }
  SIM_HD bool is_large(int body) const { return uncoloured.count[body] > large_list_size; }
#if defined(__CUDACC__)
  __device__ void process_by_block(int body) const {
    const ImpulseSums impulses = ImpulseSums::accumulate_by_block(uncoloured.count[body], entry(body));
    if (threadIdx.x == 0) apply(body, impulses);
  }
#endif

 private:
  /// Sums: momentum, and mass times displacement if positions are corrected.
  using ImpulseSums = OrderedSums<Real, 0, 1>;

  SIM_HD auto entry(int body) const {
    return [this, body](std::uint32_t k, Vector3<Real>* vectors) {
      const ContactEnd end = uncoloured.end(body, k);
      const Real sign = end.sign<Real>();
      const Vector3<Real> normal = contacts.normal[end.contact];
      vectors[0] = sign * impulse[end.contact] * normal;
      vectors[1] = correct_positions ? Vector3<Real>(sign * shift[end.contact] * normal)
                                     : Vector3<Real>(Vector3<Real>::Zero());
    };
  }
  SIM_HD void apply(int body, const ImpulseSums& impulses) const {
    bodies.velocity[body] += bodies.inverse_mass[body] * impulses.sum[0];
    if (!correct_positions) return;
    const Vector3<Real> push = bodies.inverse_mass[body] * impulses.sum[1];
    bodies.position[body] += push;
    work.add(bodies, static_cast<std::uint32_t>(body), push);
  }
};

/// Residual of a contact (residual.h): the effect of another ResolveContact.
template <class Real>
struct ImpulseResidual {
  ContactView<Real> contacts;
  BodyView<Real> bodies;
  Restitution<Real> restitution;
  const StepControl* control;
  SIM_HD ResidualSum operator()(std::int64_t contact) const {
    ResidualSum sum;
    if (contact >= static_cast<std::int64_t>(control->contacts)) return sum;
    const auto [a, b] = contacts.bodies[contact];
    const Real approach =
        -(bodies.velocity[b].load() - bodies.velocity[a].load()).dot(contacts.normal[contact]);
    const Real e = restitution.between(restitution.of_body(a), restitution.of_body(b), approach);
    const double change = approach > 0 ? static_cast<double>((1 + e) * approach) : 0.0;
    sum.add(change * change);
    return sum;
  }
};

}  // namespace

template <class Real>
ImpulseSolver<Real>::ImpulseSolver(Executor& executor, const SolverScene<Real>& scene)
    : executor_(executor),
      scene_(scene),
      h_(scene.time_step / static_cast<Real>(scene.substeps)),
      colouring_(executor),
      uncoloured_degrees_(executor),
      uncoloured_(executor),
      uncoloured_impulse_(executor, "split impulses"),
      uncoloured_correction_(executor, "split position corrections"),
      kinematic_(executor, scene.bodies, scene.kinematic, scene.control),
      free_integrator_(executor, scene),
      residuals_(executor) {}

template <class Real>
void ImpulseSolver<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  colouring_.reserve(scene_.body_count, contact_capacity);
  uncoloured_degrees_.reserve(scene_.body_count, contact_capacity);
  uncoloured_.reserve(scene_.body_count, contact_capacity);
  residuals_.reserve(contact_capacity);
  uncoloured_impulse_.resize_discarding(static_cast<std::size_t>(contact_capacity));
  uncoloured_correction_.resize_discarding(static_cast<std::size_t>(contact_capacity));
}

template <class Real>
void ImpulseSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  kinematic_.begin();
  colouring_.colour(contacts.bodies, scene_.control);
  const ColourView colours = colouring_.view();
  const ContactSet uncoloured{contacts.bodies, colours.order, colours.begin + Colouring::colours,
                              &scene_.control->uncoloured_contacts};
  uncoloured_degrees_.count("solve", uncoloured);
  uncoloured_.list("solve", uncoloured, uncoloured_degrees_);
  if (impulses != nullptr)
    executor_.run("solve", ItemCount(&scene_.control->contacts, contact_capacity_),
                  ClearImpulses<Real>{impulses});
  record_iteration(contacts, 0);
  for (int iteration = 0; iteration < scene_.iterations; ++iteration) {
    const bool correct_positions = iteration + 1 == scene_.iterations;
    iterate(contacts, {impulses}, correct_positions);
    record_iteration(contacts, iteration + 1);
  }
  free_integrator_.begin();
  if (scene_.plane_count > 0)
    executor_.run("walls", scene_.body_count,
                  ResolveWalls<Real>{scene_.bodies, scene_.planes, scene_.plane_count, scene_.restitution,
                                     scene_.gravity, h_, scene_.static_impulses,
                                     free_integrator_.start_velocity(), scene_.control});
  if (scene_.effects.drag)
    executor_.run("drag", scene_.body_count,
                  DragBodies<Real>{scene_.bodies, scene_.drag, scene_.gravity, nullptr, h_, scene_.control});
  free_integrator_.integrate(h_, false);
  free_integrator_.move(h_, false);
  kinematic_.restore(h_);
}

template <class Real>
void ImpulseSolver<Real>::iterate(const ContactView<Real>& contacts, const ImpulseSum<Real>& impulses,
                                  bool correct_positions) {
  const ColourView colours = colouring_.view();
  const ContactsByBodyView uncoloured = uncoloured_.view(uncoloured_degrees_);
  const BodyView<Real>& bodies = scene_.bodies;
  const PushWork<Real> work{scene_.gravity, scene_.static_impulses};
  // Contacts of one colour share no body, so a colour has at most body_count / 2 contacts.
  const std::int64_t colour_capacity =
      contact_capacity_ < scene_.body_count / 2 ? contact_capacity_ : scene_.body_count / 2;
  executor_.run_rounds(
      "solve", Colouring::colours, colour_capacity,
      ColourByColour<ResolveContact<Real>>{
          colours, {contacts, bodies, scene_.restitution, impulses, correct_positions, work}});
  executor_.run("solve", ItemCount(&scene_.control->uncoloured_contacts, contact_capacity_),
                ResolveUncoloured<Real>{contacts, bodies, scene_.restitution, colours.order,
                                        colours.begin + Colouring::colours, uncoloured.count,
                                        uncoloured_impulse_.data(), uncoloured_correction_.data(), impulses,
                                        correct_positions});
  executor_.run("solve", uncoloured_degrees_.bodies(),
                ApplyUncoloured<Real>{contacts, bodies, uncoloured, uncoloured_impulse_.data(),
                                      uncoloured_correction_.data(), correct_positions, work});
}

template <class Real>
void ImpulseSolver<Real>::record_iteration(const ContactView<Real>& contacts, int iteration) {
  residuals_.record(iteration, contact_capacity_,
                    ImpulseResidual<Real>{contacts, scene_.bodies, scene_.restitution, scene_.control},
                    scene_.control);
}

template <class Real>
std::vector<Residual> ImpulseSolver<Real>::residuals() const {
  std::vector<Residual> residuals;
  const int sums = scene_.iterations + 1;
  for (const ResidualSum& sum : residuals_.kept()) {
    const int k = static_cast<int>(residuals.size());
    residuals.push_back(Residuals::residual("solve", k / sums, k % sums, sum));
  }
  return residuals;
}

template class ImpulseSolver<float>;
template class ImpulseSolver<double>;

}  // namespace collidoscope
