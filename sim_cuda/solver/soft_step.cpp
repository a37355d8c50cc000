// More than 400 lines: the stages of a step share the lists of the solver.

#include "sim_cuda/solver/soft_step.h"

#include <algorithm>

#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/solver/chain_passes.h"
#include "sim_cuda/solver/soft_begin.h"
#include "sim_cuda/solver/soft_iteration.h"
#include "sim_cuda/solver/soft_prepare.h"
#include "sim_cuda/solver/soft_residual.h"
#include "sim_cuda/solver/soft_wall_stages.h"

namespace collidoscope {

template <class Real>
SoftStepSolver<Real>::SoftStepSolver(Executor& executor, const SolverScene<Real>& scene, bool coloured)
    : executor_(executor),
      scene_(scene),
      h_(scene.time_step / static_cast<Real>(scene.substeps)),
      slides_(!scene.effects.friction && (scene.effects.gravity || scene.effects.attractor)),
      passes_((coloured ? 1 : mass_split_passes) * (slides_ ? frictionless_passes : 1)),
      softness_(Softness<Real>::of(h_, scene.iterations * passes_, scene.limits_recovery(),
                                   scene.effects.friction)),
      colouring_(executor),
      coloured_(coloured),
      uncoloured_degrees_(executor),
      mass_split_degrees_(executor),
      chains_(executor),
      all_(executor),
      uncoloured_(executor),
      split_(executor),
      split_begin_(executor, "split contact starts"),
      split_count_(executor, "split contact counts"),
      ordered_contacts_(executor, "contacts in sweep order"),
      place_of_(executor, "contact sweep positions"),
      bodies_of_(executor, "contact bodies"),
      dependency_counters_(executor, "contact dependency counters"),
      step_bodies_(executor, "bodies at step start"),
      body_friction_(executor, "body friction"),
      soft_(executor, "soft contacts"),
      sums_(executor, "contact impulses per step"),
      friction_sums_(executor, "contact friction"),
      contact_inertia_(executor, "contact inertias"),
      uncoloured_change_(executor, "split impulses"),
      uncoloured_friction_(executor, "split friction"),
      impacts_(executor, scene),
      planes_(executor, scene),
      rolling_(executor),
      kinematic_(executor, scene.bodies, scene.kinematic, scene.control),
      free_integrator_(executor, scene),
      energy_guard_(executor, scene),
      continuous_(executor),
      sleeping_(executor),
      residuals_(executor),
      cache_(executor, scene.body_count, scene.effects.friction) {
  if (!coloured) {
    split_begin_.upload(std::vector<std::uint32_t>(Colouring::colours + 1, 0));
    split_count_.upload(std::vector<std::uint32_t>(Colouring::colours + 1, 0));
  }
  if (scene.effects.sleeping) {
    sleeping_.enable(scene.bodies, scene.body_count, scene.sleep, static_cast<double>(scene.time_step),
                     scene.control);
    if (scene.joints) scene.joints->exclude_sleeping(sleeping_.asleep());
  }
  if (scene.effects.rolling_resistance)
    rolling_.enable(scene.bodies, scene.body_count, scene.surfaces(), scene.rolling, scene.control);
  if (scene.effects.continuous_collision) continuous_.enable(scene.bodies, scene.body_count, scene.control);
  step_bodies_.resize_discarding(static_cast<std::size_t>(scene.body_count));
  if (scene.effects.friction) body_friction_.resize_discarding(static_cast<std::size_t>(scene.body_count));
}

template <class Real>
void SoftStepSolver<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  const auto m = static_cast<std::size_t>(contact_capacity);
  colouring_.reserve(scene_.body_count, contact_capacity);
  if (scene_.limits_recovery()) chains_.reserve(scene_.body_count, contact_capacity);
  all_.reserve(scene_.body_count, contact_capacity);
  impacts_.reserve(contact_capacity);
  uncoloured_degrees_.reserve(scene_.body_count, contact_capacity);
  uncoloured_.reserve(scene_.body_count, contact_capacity);
  if (!coloured_) {
    mass_split_degrees_.reserve(scene_.body_count, contact_capacity);
    split_.reserve(scene_.body_count, contact_capacity);
  }
  residuals_.reserve(scene_.body_count + contact_capacity);
  ordered_contacts_.resize_discarding(m);
  place_of_.resize_discarding(m);
  bodies_of_.resize_discarding(m);
  dependency_counters_.resize_discarding(m);
  soft_.resize_discarding(m);
  sums_.resize_discarding(m);
  uncoloured_change_.resize_discarding(m);
  cache_.reserve(contact_capacity);
  if (scene_.effects.rolling_resistance) rolling_.reserve(contact_capacity, cache_.capacity());
  if (!scene_.effects.friction) return;
  friction_sums_.resize_discarding(m);
  contact_inertia_.resize_discarding(m);
  uncoloured_friction_.resize_discarding(m);
}

// ---- a step ----

template <class Real>
void SoftStepSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  with_effect<&Effects::friction>(scene_.effects,
                                  [&]<bool with_friction>() { advance<with_friction>(contacts, impulses); });
}

template <class Real>
template <bool with_friction>
void SoftStepSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  begin_step(contacts);
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    executor_.begin_substep(substep);
    if (scene_.effects.attractor)
      executor_.run("attractor", scene_.body_count,
                    EvaluateField<Real>{scene_.attractors, scene_.bodies.position, scene_.field});
    impacts_.template resolve<with_friction>(ordered_contacts<with_friction>(true), planes_,
                                             all_.view(colouring_.degrees()), sleeping_.asleep(),
                                             chains_.view().count);
    begin_substep<with_friction>();
    solve<with_friction>(substep);
    move();
    relax<with_friction>(substep);
    if (scene_.effects.joints)
      scene_.joints->end_relax({energy_guard_.start_velocity(),
                                energy_guard_.moved_velocity(),
                                scene_.effects.attractor ? scene_.field : nullptr,
                                sleeping_.asleep(),
                                {}});
    energy_guard_.apply(h_, substep == 0,
                        {ordered_contacts_.data(), soft_.data(), sums_.data(), uncoloured_change_.data(),
                         all_.view(colouring_.degrees()), planes_.impulse(), planes_.friction(),
                         planes_.box_planes(), planes_.stopped(), sleeping_.asleep()},
                        contact_capacity_);
  }
  dispatch_walls<with_friction>(
      [&]<bool with_box_obstacles>(const SoftWalls<Real, with_friction, with_box_obstacles>& walls) {
        run_bodies("keep", EndWalls<Real, with_friction, with_box_obstacles>{walls, scene_.control});
      });
  free_integrator_.end_step();
  end_step(contacts, impulses);
}

/// Finds the islands of sleeping, colours and prepares contacts, and stores the displacement limits of
/// continuous collision.
template <class Real>
void SoftStepSolver<Real>::begin_step(const ContactView<Real>& contacts) {
  kinematic_.begin();
  if (scene_.effects.sleeping)
    sleeping_.find_islands(contacts, contact_capacity_,
                           scene_.joints ? scene_.joints->view() : JointView<Real>{});
  prepare(contacts);
  if (scene_.effects.continuous_collision) continuous_.begin(scene_.time_step, scene_.acceleration_margin);
}

/// Applies gravity, attractors, drag and warm starting. Solves the planes once.
template <class Real>
template <bool with_friction>
void SoftStepSolver<Real>::begin_substep() {
  free_integrator_.begin();
  if (scene_.effects.joints)
    scene_.joints->begin_substep({soft_.data(), all_.view(colouring_.degrees()), planes_.impulse(),
                                  scene_.surfaces(), scene_.body_count});
  apply_forces<with_friction>();
  if (scene_.effects.rolling_resistance) rolling_.warm_start(rolling_source());
  kinematic_.restore();
  if (scene_.effects.joints) scene_.joints->warm_start();
}

/// Iterations before the move: joints, then contacts with soft constraints, then planes.
template <class Real>
template <bool with_friction>
void SoftStepSolver<Real>::solve(int substep) {
  const Real gap = closing_gap(scene_.acceleration_margin, scene_.substeps);
  if (scene_.limits_recovery())
    chains_.list_moving<Real>({ordered_contacts_.data(), soft_.data(), all_.view(colouring_.degrees()),
                               impacts_.struck(), impacts_.any_moving(), gap},
                              colouring_);
  record_iteration<with_friction>(substep, true, 0);
  for (int iteration = 1; iteration <= scene_.iterations; ++iteration) {
    if (scene_.effects.joints) scene_.joints->solve();
    for (int pass = 1; pass <= passes_; ++pass) {
      const bool first = iteration == 1 && pass == 1,
                 last = iteration == scene_.iterations && pass == passes_;
      if (first)
        iterate_chains<with_friction>("solve", Solve<Real>{softness_, gap, false, false}, WallPass::solve);
      iterate("solve", Solve<Real>{softness_, gap, first, last});
      iterate_walls<with_friction>("solve", WallPass::solve);
    }
    record_iteration<with_friction>(substep, true, iteration);
  }
  if (scene_.effects.joints) scene_.joints->end_solve();
}

/// Integrates free motion, clamps it by continuous collision, moves bodies by h_ seconds, then updates the
/// normals and gaps of contacts.
template <class Real>
void SoftStepSolver<Real>::move() {
  free_integrator_.integrate(h_, true, energy_guard_.moved_velocity(), energy_guard_.is_free(),
                             planes_.bounced_mask());
  if (scene_.effects.continuous_collision)
    continuous_.clamp_motion(free_integrator_.bodies_with_drift_velocity(), ordered_contacts_.data(),
                             contact_capacity_, h_);
  free_integrator_.move(h_, true, sleeping_.asleep(), continuous_.motion());
  kinematic_.restore(h_);
  run_awake_contacts(executor_, "relax", contact_count(), ordered_contacts_.data(), sleeping_.asleep(),
                     UpdateContactGeometry<Real>{ordered_contacts_.data(), bodies_of_.data(),
                                                 scene_.bodies.position, soft_.data()});
}

/// Iterations after the move, with rigid constraints and friction: joints, planes, contacts, rolling
/// resistance. Removes the velocity that the correction of overlap has added.
template <class Real>
template <bool with_friction>
void SoftStepSolver<Real>::relax(int substep) {
  record_iteration<with_friction>(substep, false, 0);
  for (int iteration = 1; iteration <= scene_.iterations; ++iteration) {
    if (scene_.effects.joints) scene_.joints->relax(iteration == 1, energy_guard_.moved_velocity());
    for (int pass = 1; pass <= passes_; ++pass) {
      const bool first = iteration == 1 && pass == 1,
                 last = iteration == scene_.iterations && pass == passes_;
      // With mass splitting, a later pass may find bodies that the others have pushed only in part.
      const bool stops = first || coloured_;
      iterate_walls<with_friction>("relax", stops ? WallPass::relax : WallPass::relax_without_stops);
      if (first)
        iterate_chains<with_friction>("relax", Relax<Real, with_friction, false>{softness_, false},
                                      WallPass::relax_without_stops);
      with_moments<with_friction>([&]<bool unequal_moments>() {
        iterate("relax", Relax<Real, with_friction, unequal_moments>{softness_, last});
      });
      if (scene_.effects.rolling_resistance) rolling_.solve(rolling_source());
    }
    record_iteration<with_friction>(substep, false, iteration);
  }
}

/// Stores the impulses of contacts for warm starting of the next step. Updates the sleep timers.
template <class Real>
void SoftStepSolver<Real>::end_step(const ContactView<Real>& contacts, Real* impulses) {
  kinematic_.restore();
  executor_.run("keep", contact_count(),
                cache_.store_stage(contacts.bodies, place_of_.data(), soft_.data(), sums_.data(), impulses));
  if (scene_.effects.rolling_resistance) rolling_.store_impulses(rolling_source());
  executor_.run("keep", 1, EndStep{scene_.control, cache_.count()});
  if (scene_.effects.sleeping) sleeping_.update_timers();
}

// ---- parts of the phases ----

template <class Real>
template <class Stage>
void SoftStepSolver<Real>::run_bodies(const char* name, const Stage& stage) {
  run_awake_bodies(executor_, name, scene_.body_count, sleeping_.asleep(), stage);
}

/// Colours the contacts and copies them into solve order, with their warm-start impulses. Lists contacts by
/// body: all of them, and the mass-split set.
template <class Real>
void SoftStepSolver<Real>::prepare(const ContactView<Real>& contacts) {
  StepControl* control = scene_.control;
  colouring_.colour(contacts.bodies, control, sleeping_.asleep());
  const ColourView colours = colouring_.view();
  const PreviousContacts previous = cache_.view();
  executor_.run("prepare", colouring_.degrees().bodies(),
                PackBodies<Real>{scene_.friction, body_friction_.data(), scene_.bodies, step_bodies_.data()});
  executor_.run(
      "prepare", contact_count(),
      PrepareContacts<Real>{contacts.bodies, step_bodies_.data(), body_friction_.data(), previous,
                            cache_.impulse(), cache_.friction(), colours, place_of_.data(),
                            ordered_contacts_.data(), bodies_of_.data(), dependency_counters_.data(),
                            soft_.data(), friction_sums_.data(), contact_inertia_.data(), sums_.data()});
  if (scene_.limits_recovery())
    chains_.list(ordered_contacts_.data(), colouring_, control, sleeping_.asleep());
  const ContactSet all{contacts.bodies, nullptr, nullptr, &control->contacts};
  all_.list("prepare", all, colouring_.degrees(), place_of_.data());
  const ContactSet uncoloured{contacts.bodies, colours.order, colours.begin + Colouring::colours,
                              colours.count + Colouring::colours};
  uncoloured_degrees_.count("prepare", uncoloured);
  uncoloured_.list("prepare", uncoloured, uncoloured_degrees_, place_of_.data());
  if (!coloured_) {
    executor_.run("prepare", 1, SplitAll{colours, split_count_.data() + Colouring::colours, control});
    const ContactSet split{contacts.bodies, colours.order, split_begin_.data() + Colouring::colours,
                           split_count_.data() + Colouring::colours};
    mass_split_degrees_.count("prepare", split);
    split_.list("prepare", split, mass_split_degrees_, place_of_.data());
  }
  if (scene_.effects.rolling_resistance) rolling_.prepare(rolling_source(), previous);
}

template <class Real>
RollingSource<Real> SoftStepSolver<Real>::rolling_source() const {
  return {ordered_contacts_.data(), soft_.data(),      place_of_.data(),  all_.view(colouring_.degrees()),
          contact_count(),          planes_.impulse(), sleeping_.asleep()};
}

/// The forces and the warm starting of begin_substep().
template <class Real>
template <bool with_friction>
void SoftStepSolver<Real>::apply_forces() {
  if (scene_.effects.drag)
    run_bodies("drag", DragBodies<Real>{scene_.bodies, scene_.drag, scene_.gravity, scene_.field, h_,
                                        scene_.control});
  if (energy_guard_.start_rotation() != nullptr)
    run_bodies("forces", StoreRotationEnergy<Real>{scene_.bodies, energy_guard_.start_rotation()});
  const auto with = [&]<bool with_box_obstacles>() {
    run_bodies("forces", BeginSubstep<Real, with_friction, with_box_obstacles>{
                             scene_.bodies, soft_.data(), all_.view(colouring_.degrees()),
                             planes_.template view<with_friction, with_box_obstacles>(softness_.inverse_h),
                             scene_.gravity, scene_.effects.attractor ? scene_.field : nullptr,
                             scene_.effects.gravity || scene_.effects.attractor, h_,
                             energy_guard_.start_velocity(), energy_guard_.start_spin(), scene_.control});
  };
  scene_.boxes.count > 0 ? with.template operator()<true>() : with.template operator()<false>();
}

template <class Real>
template <bool with_friction>
OrderedContacts<Real, with_friction> SoftStepSolver<Real>::ordered_contacts(bool coloured) const {
  const ColourView colours = colouring_.view();
  return {ordered_contacts_.data(),
          bodies_of_.data(),
          soft_.data(),
          sums_.data(),
          friction_sums_.data(),
          contact_inertia_.data(),
          dependency_counters_.data(),
          coloured ? colours.begin : split_begin_.data(),
          coloured ? colours.count : split_count_.data(),
          coloured ? uncoloured_.view(uncoloured_degrees_) : split_.view(mass_split_degrees_),
          (coloured ? uncoloured_degrees_ : mass_split_degrees_).body_items(),
          uncoloured_friction_.data(),
          uncoloured_change_.data()};
}

/// One pass of `act` over all contacts, timed as `stage`.
template <class Real>
template <class Act>
void SoftStepSolver<Real>::iterate(const char* stage, const Act& act) {
  // Contacts of one colour share no body, so a colour has at most body_count / 2 contacts.
  executor_.run_rounds(
      stage, Iteration<Real, Act>::rounds, std::min(contact_capacity_, scene_.body_count / 2),
      Iteration<Real, Act>{ordered_contacts<Act::has_friction>(coloured_), scene_.bodies, act});
}

/// Passes of `act` over chain contacts and the planes and boxes of their bodies, timed as `stage`.
template <class Real>
template <bool with_friction, class Act>
void SoftStepSolver<Real>::iterate_chains(const char* stage, const Act& act, WallPass pass) {
  if (!scene_.limits_recovery()) return;
  // For all scenes, because each version takes long to compile. Friction of unequal moments of inertia is too
  // small in these passes, as if all were the smallest; the passes after them are exact.
  using Walls = SolveWalls<Real, with_friction, true, false>;
  using Passes = ChainPasses<Real, Act, Walls>;
  executor_.run_rounds(
      stage, Passes::rounds, std::min(contact_capacity_, scene_.body_count / 2),
      Passes{{ordered_contacts<Act::has_friction>(true), scene_.bodies, {act}},
             Walls{planes_.template view<with_friction, true>(softness_.inverse_h), pass, scene_.control},
             chains_.view(),
             impacts_.struck()});
}

/// Records the residual after an iteration of solve (`soft`) or relax. `iteration` 0: before the first one.
template <class Real>
template <bool with_friction>
void SoftStepSolver<Real>::record_iteration(int substep, bool soft, int iteration) {
  if (!residuals_.on()) return;
  const int sums = scene_.iterations + 1, place = (2 * substep + (soft ? 0 : 1)) * sums + iteration;
  const auto with = [&]<bool with_box_obstacles>() {
    residuals_.record(
        place, scene_.body_count + contact_capacity_,
        SoftResidual<Real, with_friction, with_box_obstacles>{
            planes_.template view<with_friction, with_box_obstacles>(softness_.inverse_h),
            ordered_contacts<with_friction>(coloured_), softness_, soft, sleeping_.asleep(), scene_.control},
        scene_.control);
  };
  scene_.boxes.count > 0 ? with.template operator()<true>() : with.template operator()<false>();
}

/// Passes the view of planes and box obstacles to `launch`, if the scene has any.
template <class Real>
template <bool with_friction, class Launch>
void SoftStepSolver<Real>::dispatch_walls(const Launch& launch) {
  if (scene_.boxes.count > 0)
    launch(planes_.template view<with_friction, true>(softness_.inverse_h));
  else if (scene_.plane_count > 0)
    launch(planes_.template view<with_friction, false>(softness_.inverse_h));
}

/// One pass over planes and box obstacles, timed as `stage`.
template <class Real>
template <bool with_friction>
void SoftStepSolver<Real>::iterate_walls(const char* stage, WallPass pass) {
  dispatch_walls<with_friction>(
      [&]<bool with_box_obstacles>(const SoftWalls<Real, with_friction, with_box_obstacles>& walls) {
        with_moments<with_friction>([&]<bool unequal_moments>() {
          run_bodies(stage, SolveWalls<Real, with_friction, with_box_obstacles, unequal_moments>{
                                walls, pass, scene_.control});
        });
      });
}

template class SoftStepSolver<float>;
template class SoftStepSolver<double>;

}  // namespace collidoscope
