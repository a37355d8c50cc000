#include "sim_cuda/solver/soft_step.h"

#include <algorithm>

#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/solver/soft_begin.h"
#include "sim_cuda/solver/soft_prepare.h"
#include "sim_cuda/solver/soft_residual.h"
#include "sim_cuda/solver/soft_sweeps.h"
#include "sim_cuda/solver/soft_wall_stages.h"

namespace collidoscope {

template <class Real>
SoftStepSolver<Real>::SoftStepSolver(Executor& executor, const SolverScene<Real>& scene, bool coloured)
    : executor_(executor),
      scene_(scene),
      h_(scene.time_step / static_cast<Real>(scene.substeps)),
      softness_(Softness<Real>::of(h_)),
      colouring_(executor, coloured),
      split_degrees_(executor),
      all_(executor),
      split_(executor),
      swept_(executor, "contacts in the order of sweeps"),
      place_of_(executor, "places of contacts"),
      bodies_of_(executor, "bodies of contacts"),
      turns_(executor, "turns of contacts"),
      found_(executor, "bodies as the step finds them"),
      gripped_(executor, "friction of bodies"),
      soft_(executor, "contacts of the solver"),
      sums_(executor, "what contacts gave in a step"),
      grips_(executor, "friction of contacts"),
      turned_(executor, "bodies of friction"),
      split_change_(executor, "split impulses"),
      split_rubbed_(executor, "split friction"),
      bounces_(executor, "whether something bounces"),
      planes_(executor, scene),
      rolling_(executor),
      prescribed_(executor, scene.bodies, scene.prescribed, scene.control),
      free_motion_(executor, scene),
      continuous_(executor),
      sleeping_(executor),
      residuals_(executor),
      cache_(executor, scene.body_count, scene.effects.friction) {
  bounces_.upload({0});
  if (scene.effects.sleeping) {
    sleeping_.enable(scene.bodies, scene.body_count, scene.sleep, static_cast<double>(scene.time_step),
                     scene.control);
    if (scene.joints) scene.joints->leave_out(sleeping_.asleep());
  }
  if (scene.effects.rolling_resistance)
    rolling_.enable(scene.bodies, scene.body_count, scene.surfaces(), scene.rolling, scene.control);
  if (scene.effects.continuous_collision) continuous_.enable(scene.bodies, scene.body_count, scene.control);
  found_.resize_discarding(static_cast<std::size_t>(scene.body_count));
  if (scene.effects.friction) gripped_.resize_discarding(static_cast<std::size_t>(scene.body_count));
}

template <class Real>
void SoftStepSolver<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  const auto m = static_cast<std::size_t>(contact_capacity);
  colouring_.reserve(scene_.body_count, contact_capacity);
  all_.reserve(scene_.body_count, contact_capacity);
  split_degrees_.reserve(scene_.body_count, contact_capacity);
  split_.reserve(scene_.body_count, contact_capacity);
  residuals_.reserve(scene_.body_count + contact_capacity);
  swept_.resize_discarding(m);
  place_of_.resize_discarding(m);
  bodies_of_.resize_discarding(m);
  turns_.resize_discarding(m);
  soft_.resize_discarding(m);
  sums_.resize_discarding(m);
  split_change_.resize_discarding(m);
  cache_.reserve(contact_capacity);
  if (scene_.effects.rolling_resistance) rolling_.reserve(contact_capacity, cache_.capacity());
  if (!scene_.effects.friction) return;
  grips_.resize_discarding(m);
  turned_.resize_discarding(m);
  split_rubbed_.resize_discarding(m);
}

template <class Real>
SolverMemory SoftStepSolver<Real>::memory() const {
  SolverMemory memory;
  if (scene_.joints) memory.joints = scene_.joints->memory();
  cache_.save(memory);
  planes_.save(memory);
  rolling_.memory(memory.contacts.size(), memory);
  memory.slow = sleeping_.memory();
  return memory;
}

template <class Real>
void SoftStepSolver<Real>::visit_memory(const ArrayVisit& visit) {
  cache_.visit(visit);
  planes_.visit(visit);
  rolling_.visit_memory(*cache_.count(), visit);
  sleeping_.visit_memory(visit);
  if (scene_.joints) scene_.joints->visit_memory(visit);
}

template <class Real>
void SoftStepSolver<Real>::remember(const SolverMemory& memory) {
  cache_.load(memory);
  rolling_.remember(memory, std::max(static_cast<std::size_t>(contact_capacity_), memory.contacts.size()));
  if (scene_.joints) scene_.joints->remember(memory.joints);
  if (scene_.effects.sleeping) sleeping_.remember(memory.slow);
  planes_.load(memory);
}

// ---- a step ----

template <class Real>
void SoftStepSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  with_effect<&Effects::friction>(scene_.effects,
                                  [&]<bool rubbed>() { advance<rubbed>(contacts, impulses); });
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  begin_step(contacts);
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    begin_substep<rubbed>(substep);
    solve<rubbed>(substep);
    move();
    relax<rubbed>(substep);
  }
  bounce<rubbed>();
  if constexpr (rubbed) friction_of_bounces();
  end_step(contacts, impulses);
}

/// Islands, colours, warm starts, and the bounds of continuous collision.
template <class Real>
void SoftStepSolver<Real>::begin_step(const ContactView<Real>& contacts) {
  prescribed_.begin();
  if (scene_.effects.sleeping)
    sleeping_.find_islands(contacts, contact_capacity_,
                           scene_.joints ? scene_.joints->view() : JointView<Real>{});
  prepare(contacts);
  if (scene_.effects.continuous_collision) continuous_.begin(scene_.time_step, scene_.slack);
}

/// Forces and warm starts.
template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::begin_substep(int substep) {
  executor_.begin_substep(substep);
  free_motion_.begin();
  if (scene_.effects.rolling_resistance) rolling_.warm_start(rolling_source());
  apply_forces<rubbed>();
  prescribed_.hold();
  if (scene_.effects.joints) scene_.joints->warm_start();
}

/// Sweeps over joints, contacts and planes, with soft constraints.
template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::solve(int substep) {
  record_sweep<rubbed>(substep, true, 0);
  for (int sweeps = 1; sweeps <= scene_.iterations; ++sweeps) {
    if (scene_.effects.joints) scene_.joints->solve();
    with_effect<&Effects::continuous_collision>(scene_.effects, [&]<bool held>() {
      sweep("solve", Solve<Real, held>{scene_.bodies.radius, softness_});
    });
    sweep_walls<rubbed>("solve", false, false);
    record_sweep<rubbed>(substep, true, sweeps);
  }
}

/// Moves bodies, and takes normals and gaps of contacts from the new positions.
template <class Real>
void SoftStepSolver<Real>::move() {
  free_motion_.fly(h_, true);
  if (scene_.effects.continuous_collision)
    continuous_.hold(free_motion_.ways(), swept_.data(), contact_capacity_, h_);
  free_motion_.move(h_, true, sleeping_.asleep(), continuous_.motion());
  prescribed_.hold(h_);
  run_awake_contacts(
      executor_, "relax", contact_count(), swept_.data(), sleeping_.asleep(),
      PlaceContacts<Real>{swept_.data(), bodies_of_.data(), scene_.bodies.position, soft_.data()});
}

/// Sweeps with rigid constraints, and friction.
template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::relax(int substep) {
  record_sweep<rubbed>(substep, false, 0);
  for (int sweeps = 1; sweeps <= scene_.iterations; ++sweeps) {
    const bool last = sweeps == scene_.iterations;
    if (scene_.effects.joints) scene_.joints->relax();
    sweep_walls<rubbed>("relax", true, last);
    sweep("relax", Relax<Real, rubbed>{softness_, scene_.bodies.radius, last, scene_.restitution,
                                       last && substep + 1 == scene_.substeps ? bounces_.data() : nullptr});
    if (scene_.effects.rolling_resistance) rolling_.resist(rolling_source());
    record_sweep<rubbed>(substep, false, sweeps);
  }
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::bounce() {
  on_walls<rubbed>([&]<bool boxed>(const SoftWalls<Real, rubbed, boxed>& walls) {
    run_bodies("bounce", BounceOffWalls<Real, rubbed, boxed>{walls, scene_.control});
  });
  sweep("bounce", Bounce<Real>{scene_.restitution, bounces_.data()});
}

template <class Real>
void SoftStepSolver<Real>::friction_of_bounces() {
  on_walls<true>([&]<bool boxed>(const SoftWalls<Real, true, boxed>& walls) {
    run_bodies("friction", GripWalls<Real, boxed>{walls, scene_.control});
  });
  sweep("friction", Grip<Real>{bounces_.data()});
}

/// Fills the contact cache.
template <class Real>
void SoftStepSolver<Real>::end_step(const ContactView<Real>& contacts, Real* impulses) {
  prescribed_.hold();
  executor_.run("keep", contact_count(),
                cache_.keeping(contacts.bodies, place_of_.data(), soft_.data(), sums_.data(), impulses));
  if (scene_.effects.rolling_resistance) rolling_.keep(rolling_source());
  executor_.run("keep", 1, EndStep{scene_.control, cache_.count(), bounces_.data()});
  if (scene_.effects.sleeping) sleeping_.count();
}

// ---- its parts ----

template <class Real>
template <class Stage>
void SoftStepSolver<Real>::run_bodies(const char* name, const Stage& stage) {
  run_awake_bodies(executor_, name, scene_.body_count, sleeping_.asleep(), stage);
}

template <class Real>
void SoftStepSolver<Real>::prepare(const ContactView<Real>& contacts) {
  StepControl* control = scene_.control;
  colouring_.colour(contacts.bodies, control, sleeping_.asleep());
  const ColourView colours = colouring_.view();
  const KnownContacts known = cache_.view();
  executor_.run("prepare", colouring_.degrees().bodies(),
                FindBodies<Real>{scene_.friction, gripped_.data(), scene_.bodies, found_.data()});
  executor_.run(
      "prepare", contact_count(),
      PrepareContacts<Real>{contacts.bodies, found_.data(), gripped_.data(), known, cache_.impulse(),
                            cache_.friction(), colours, place_of_.data(), swept_.data(), bodies_of_.data(),
                            turns_.data(), soft_.data(), grips_.data(), turned_.data(), sums_.data()});
  const ContactSet all{contacts.bodies, nullptr, nullptr, &control->contacts};
  all_.list("prepare", all, colouring_.degrees(), place_of_.data());
  const ContactSet split{contacts.bodies, colours.order, colours.begin + Colouring::colours,
                         &control->split_contacts};
  split_degrees_.count("prepare", split);
  split_.list("prepare", split, split_degrees_, place_of_.data());
  if (scene_.effects.rolling_resistance) rolling_.prepare(rolling_source(), known);
}

template <class Real>
RollingSource<Real> SoftStepSolver<Real>::rolling_source() const {
  return {swept_.data(),   soft_.data(),      place_of_.data(),  all_.view(colouring_.degrees()),
          contact_count(), planes_.impulse(), sleeping_.asleep()};
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::apply_forces() {
  if (scene_.effects.attractor)
    executor_.run("attractor", scene_.body_count,
                  PullBodies<Real>{scene_.attractors, scene_.bodies.position, scene_.field});
  if (scene_.effects.drag)
    run_bodies("drag", DragBodies<Real>{scene_.bodies, scene_.drag, scene_.gravity, scene_.field, h_,
                                        scene_.control});
  const auto with = [&]<bool boxed>() {
    run_bodies("forces", BeginSubstep<Real, rubbed, boxed>{
                             scene_.bodies, soft_.data(), all_.view(colouring_.degrees()),
                             planes_.template view<rubbed, boxed>(softness_.inverse_h), scene_.gravity,
                             scene_.effects.attractor ? scene_.field : nullptr,
                             scene_.effects.gravity || scene_.effects.attractor, h_, scene_.control});
  };
  scene_.boxes.count > 0 ? with.template operator()<true>() : with.template operator()<false>();
}

template <class Real>
template <bool rubs>
SweptContacts<Real, rubs> SoftStepSolver<Real>::swept() const {
  const ColourView colours = colouring_.view();
  return {swept_.data(),
          bodies_of_.data(),
          soft_.data(),
          sums_.data(),
          grips_.data(),
          turned_.data(),
          turns_.data(),
          colours.begin,
          colours.count,
          split_.view(split_degrees_),
          split_degrees_.body_items(),
          split_rubbed_.data(),
          split_change_.data()};
}

template <class Real>
template <class Act>
void SoftStepSolver<Real>::sweep(const char* stage, const Act& act) {
  // Contacts of one colour share no body, so there are at most half as many as bodies.
  executor_.run_rounds(stage, Sweep<Real, Act>::rounds, std::min(contact_capacity_, scene_.body_count / 2),
                       Sweep<Real, Act>{swept<Act::rubs>(), scene_.bodies, act});
}

/// In each substep: before the first of the sweeps that solve, after each of them, and the same of those that
/// relax.
template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::record_sweep(int substep, bool soft, int sweep) {
  if (!residuals_.on()) return;
  const int sums = scene_.iterations + 1, place = (2 * substep + (soft ? 0 : 1)) * sums + sweep;
  const auto with = [&]<bool boxed>() {
    residuals_.record(
        place, scene_.body_count + contact_capacity_,
        SoftResidual<Real, rubbed, boxed>{planes_.template view<rubbed, boxed>(softness_.inverse_h),
                                          swept<rubbed>(), softness_, soft, sleeping_.asleep(),
                                          scene_.effects.continuous_collision, scene_.control},
        scene_.control);
  };
  scene_.boxes.count > 0 ? with.template operator()<true>() : with.template operator()<false>();
}

template <class Real>
void SoftStepSolver<Real>::record_residuals(bool on) {
  residuals_.enable(on, 1, scene_.substeps * 2 * (scene_.iterations + 1));
}

template <class Real>
std::vector<Residual> SoftStepSolver<Real>::residuals() const {
  std::vector<Residual> residuals;
  const int sums = scene_.iterations + 1;
  for (const ResidualSum& sum : residuals_.kept()) {
    const int k = static_cast<int>(residuals.size());
    residuals.push_back(
        Residuals::residual(k / sums % 2 == 0 ? "solve" : "relax", k / sums / 2, k % sums, sum));
  }
  return residuals;
}

template <class Real>
template <bool rubbed, class With>
void SoftStepSolver<Real>::on_walls(const With& with) {
  if (scene_.boxes.count > 0)
    with(planes_.template view<rubbed, true>(softness_.inverse_h));
  else if (scene_.plane_count > 0)
    with(planes_.template view<rubbed, false>(softness_.inverse_h));
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::sweep_walls(const char* stage, bool relaxing, bool last) {
  on_walls<rubbed>([&]<bool boxed>(const SoftWalls<Real, rubbed, boxed>& walls) {
    run_bodies(stage, SolveWalls<Real, rubbed, boxed>{walls, relaxing, last, scene_.control});
  });
}

template class SoftStepSolver<float>;
template class SoftStepSolver<double>;

}  // namespace collidoscope
