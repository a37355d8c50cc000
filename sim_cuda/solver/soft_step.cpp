#include "sim_cuda/solver/soft_step.h"

#include <algorithm>

#include "sim_cuda/core/whole_record.h"
#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/solver/soft_residual.h"
#include "sim_cuda/solver/soft_sweeps.h"

namespace collidoscope {

namespace {

/// What the run before left behind of friction, beside the impulses.
template <class Real>
struct KnownGrips {
  Friction<Real> friction;
  const Vector3<Real>* impulse;
};

/// Puts contacts in the order in which they are swept. New ones start from rest, known ones from what they
/// last gave.
template <class Real, bool rubbed>
struct PrepareContacts {
  const Pair* contacts;
  BodyView<Real> bodies;
  ImpulseView<Real> known;
  [[no_unique_address]] Only<rubbed, KnownGrips<Real>> known_grips;
  ColourView colours;
  std::uint32_t* place_of;
  Pair* bodies_of;
  InverseMasses<Real>* inverse_masses;
  Turns* turns;
  [[no_unique_address]] Only<rubbed, SoftGrip<Real>*> grips;
  [[no_unique_address]] Only<rubbed, GrippedPair<Real>*> gripped;
  SoftContact<Real>* soft;

  SIM_HD void operator()(int place) const {
    const std::uint32_t contact = colours.order[place];
    const auto [a, b] = contacts[contact];
    place_of[contact] = static_cast<std::uint32_t>(place);
    bodies_of[place] = {a, b};
    inverse_masses[place] = {bodies.inverse_mass[a], bodies.inverse_mass[b]};
    if (colours.colour[place] < Colouring::colours)
      turns[place] = Turns::of(colours.bodies[a].used, colours.bodies[b].used, colours.colour[place]);
    const std::uint32_t before = known.find(a, b);
    const bool found = before != ImpulseView<Real>::none;
    SoftContact<Real> k;
    k.place(bodies, a, b);
    k.impulse = found ? known.impulse[before] : Real(0);
    k.total = 0;
    k.approach = k.meeting_speed(bodies.velocity[b].load() - bodies.velocity[a].load(),
                                 bodies.radius[a] + bodies.radius[b]);
    k.radius = min_of(bodies.radius[a], bodies.radius[b]);
    store_whole(&soft[place], k);
    if constexpr (rubbed) {
      SoftGrip<Real> grip;
      grip.impulse = found ? known_grips.impulse[before] : Vector3<Real>(Vector3<Real>::Zero());
      grip.coefficient =
          Friction<Real>::between(known_grips.friction.of_body(a), known_grips.friction.of_body(b));
      grip.total = Vector3<Real>::Zero();
      store_whole(&grips[place], grip);
      store_whole(&gripped[place], GrippedPair<Real>::of(bodies, {a, b}));
    }
  }
};

template <class Real>
struct PlaceContacts {
  const Pair* bodies_of;
  BodyView<Real> bodies;
  SoftContact<Real>* soft;
  SIM_HD void operator()(int place) const {
    const auto [a, b] = bodies_of[place];
    SoftContact<Real> k;
    k.place(bodies, a, b);
    k.store_face(&soft[place]);
  }
};

/// The acceleration of a substep.
enum class Pull { none, uniform, field };

/// Forces, the impulses of the substep before, and the first sweep over the planes.
template <class Real, Pull pull, bool walled, bool rubbed, bool boxed>
struct BeginSubstep {
  BodyView<Real> bodies;
  const Pair* bodies_of;
  const SoftContact<Real>* soft;
  [[no_unique_address]] Only<rubbed, const SoftGrip<Real>*> grips;
  ContactsByBodyView by_body;
  SoftWalls<Real, rubbed, boxed> walls;
  Vector3<Real> gravity;  ///< m/s^2
  /// m/s^2, by body
  [[no_unique_address]] Only<pull == Pull::field, const Vector3<Real>*> field;
  Real h;  ///< s
  const StepControl* control;

  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    typename SoftWalls<Real, rubbed, boxed>::Body body = walls.load(id);
    const Vector3<Real> before = body.v;
    SoftWalls<Real, rubbed, boxed> own = walls;
    if constexpr (pull == Pull::field) own.gravity = gravity + field[id];
    if constexpr (pull != Pull::none) body.v += h * own.gravity;
    if constexpr (boxed) own.face_boxes(id, body);
    if constexpr (walled) own.warm_start(id, body);
    if (control->contacts > 0) warm_start(id, body);
    if constexpr (walled) own.solve(id, body, false, &before);
    body.given = true;
    walls.store(id, body);
  }

  SIM_HD void warm_start(int id, typename SoftWalls<Real, rubbed, boxed>::Body& body) const {
    const std::uint32_t n = by_body.count[id];
    if (n == 0) return;
    Vector3<Real> momentum = Vector3<Real>::Zero();
    [[maybe_unused]] Vector3<Real> moment = Vector3<Real>::Zero();
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t place = by_body.entry[by_body.begin[id] + k];
      const Real sign = bodies_of[place].a == static_cast<std::uint32_t>(id) ? Real(-1) : Real(1);
      const SoftContact<Real> contact = load_whole(&soft[place]);
      momentum += sign * contact.impulse * contact.normal;
      if constexpr (rubbed) {
        const Vector3<Real> rubbing = load_whole(&grips[place]).impulse;
        momentum += sign * rubbing;
        moment -= (body.radius + contact.gap / 2) * contact.normal.cross(rubbing);
      }
    }
    body.v += body.inverse_mass * momentum;
    if constexpr (rubbed) body.spin.turn(moment);
  }
};

/// What the next run starts from. `record`: what the step gave, too.
template <class Real, bool rubbed, bool record>
struct KeepContacts {
  const Pair* contacts;
  const std::uint32_t* place_of;
  const SoftContact<Real>* soft;
  [[no_unique_address]] Only<rubbed, const SoftGrip<Real>*> grips;
  [[no_unique_address]] Only<rubbed, Vector3<Real>*> known_grip;
  [[no_unique_address]] Only<record, Real*> total;
  Pair* known_contacts;
  Real* known_impulse;
  SIM_HD void operator()(int contact) const {
    const std::uint32_t place = place_of[contact];
    known_contacts[contact] = contacts[contact];
    const SoftContact<Real> kept = load_whole(&soft[place]);
    const Real impulse = kept.impulse;
    known_impulse[contact] = impulse;
    if constexpr (rubbed)
      known_grip[contact] = impulse > 0 ? grips[place].impulse : Vector3<Real>(Vector3<Real>::Zero());
    if constexpr (record) total[contact] = kept.total;
  }
};

struct EndStep {
  const StepControl* control;
  std::uint32_t *count, *bounces;
  SIM_HD void operator()(int) const {
    if (!control->overflow) *count = control->contacts;
    *bounces = 0;
  }
};

template <class Real>
std::vector<std::array<double, 3>> widened(const std::vector<Vector3<Real>>& vectors, std::size_t count) {
  std::vector<std::array<double, 3>> wide;
  for (std::size_t k = 0; k < count; ++k)
    wide.push_back({static_cast<double>(vectors[k].x()), static_cast<double>(vectors[k].y()),
                    static_cast<double>(vectors[k].z())});
  return wide;
}
template <class Real>
Vector3<Real> narrowed(const std::array<double, 3>& v) {
  return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

}  // namespace

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
      inverse_masses_(executor, "inverse masses of contacts"),
      turns_(executor, "turns of contacts"),
      soft_(executor, "contacts of the solver"),
      grips_(executor, "friction of contacts"),
      gripped_(executor, "bodies of friction"),
      split_change_(executor, "split impulses"),
      split_rubbed_(executor, "split friction"),
      bounces_(executor, "whether something bounces"),
      wall_impulse_(executor, "impulses of walls"),
      wall_bounce_(executor, "bounces off walls"),
      wall_at_(executor, "walls of bodies"),
      wall_grip_(executor, "friction at walls"),
      wall_grip_total_(executor, "friction at walls in a step"),
      wall_pressed_(executor, "impulses of walls in a step"),
      box_face_(executor, "faces of boxes"),
      box_touched_(executor, "normals of boxes"),
      rolling_(executor),
      prescribed_(executor, scene.bodies, scene.prescribed, scene.control),
      free_motion_(executor, scene),
      continuous_(executor),
      sleeping_(executor),
      residuals_(executor),
      known_contacts_(executor, "contacts of the last step"),
      known_impulse_(executor, "impulses of the last step"),
      known_grip_(executor, "friction of the last step"),
      known_count_(executor, "number of contacts of the last step") {
  const auto walls = static_cast<std::size_t>(scene.surfaces()) * static_cast<std::size_t>(scene.body_count);
  wall_impulse_.upload(std::vector<Real>(walls, 0));
  wall_bounce_.upload(std::vector<Real>(walls, -1));
  ask_all_walls();
  const auto boxes = static_cast<std::size_t>(scene.boxes.count) * static_cast<std::size_t>(scene.body_count);
  box_face_.resize_discarding(boxes);
  box_touched_.resize_discarding(boxes);
  known_count_.upload({0});
  bounces_.upload({0});
  if (scene.effects.sleeping) {
    sleeping_.enable(scene.bodies, scene.body_count, scene.sleep, static_cast<double>(scene.time_step),
                     scene.control);
    if (scene.joints) scene.joints->leave_out(sleeping_.asleep());
  }
  if (scene.effects.rolling_resistance)
    rolling_.enable(scene.bodies, scene.body_count, scene.surfaces(), scene.rolling, scene.control);
  if (scene.effects.continuous_collision) continuous_.enable(scene.bodies, scene.body_count, scene.control);
  if (!scene.effects.friction) return;
  wall_grip_.upload(std::vector<Vector3<Real>>(walls, Vector3<Real>::Zero()));
  wall_grip_total_.upload(std::vector<Vector3<Real>>(walls, Vector3<Real>::Zero()));
  wall_pressed_.upload(std::vector<Real>(walls, 0));
}

template <class Real>
void SoftStepSolver<Real>::reserve(std::int64_t contact_capacity) {
  contact_capacity_ = contact_capacity;
  const auto m = static_cast<std::size_t>(contact_capacity), known = std::max(m, remembered_);
  colouring_.reserve(scene_.body_count, contact_capacity);
  all_.reserve(scene_.body_count, contact_capacity);
  split_degrees_.reserve(scene_.body_count, contact_capacity);
  split_.reserve(scene_.body_count, contact_capacity);
  residuals_.reserve(scene_.body_count + contact_capacity);
  swept_.resize_discarding(m);
  place_of_.resize_discarding(m);
  inverse_masses_.resize_discarding(m);
  turns_.resize_discarding(m);
  soft_.resize_discarding(m);
  split_change_.resize_discarding(m);
  known_contacts_.resize_keeping(known);
  known_impulse_.resize_keeping(known);
  if (scene_.effects.rolling_resistance) rolling_.reserve(contact_capacity, known);
  if (!scene_.effects.friction) return;
  grips_.resize_discarding(m);
  gripped_.resize_discarding(m);
  split_rubbed_.resize_discarding(m);
  known_grip_.resize_keeping(known);
}

template <class Real>
SolverMemory SoftStepSolver<Real>::memory() const {
  SolverMemory memory;
  if (scene_.joints) memory.joints = scene_.joints->memory();
  const std::size_t count = known_count_.download()[0];
  const std::vector<Pair> contacts = known_contacts_.download(count);
  const std::vector<Real> impulse = known_impulse_.download(count);
  for (std::size_t k = 0; k < count; ++k)
    memory.contacts.push_back({contacts[k].a, contacts[k].b, static_cast<double>(impulse[k])});
  const std::vector<Real> walls = wall_impulse_.download();
  for (auto plane = walls.begin(); plane != walls.end(); plane += scene_.body_count)
    memory.walls.emplace_back(plane, plane + scene_.body_count);
  rolling_.memory(count, memory);
  memory.slow = sleeping_.memory();
  if (!scene_.effects.friction) return memory;
  memory.grips = widened<Real>(known_grip_.download(count), count);
  memory.wall_grips = widened<Real>(wall_grip_.download(), wall_grip_.size());
  return memory;
}

template <class Real>
void SoftStepSolver<Real>::remember(const SolverMemory& memory) {
  const std::size_t count = memory.contacts.size();
  const bool grips = scene_.effects.friction && memory.grips.size() == count;
  remembered_ = count;
  const auto m = std::max(static_cast<std::size_t>(contact_capacity_), count);
  std::vector<Pair> contacts(m);
  std::vector<Real> impulse(m);
  std::vector<Vector3<Real>> grip(scene_.effects.friction ? m : 0, Vector3<Real>::Zero());
  for (std::size_t k = 0; k < count; ++k) {
    contacts[k] = {memory.contacts[k].a, memory.contacts[k].b};
    impulse[k] = static_cast<Real>(memory.contacts[k].impulse);
    if (grips) grip[k] = narrowed<Real>(memory.grips[k]);
  }
  known_contacts_.upload(contacts);
  known_impulse_.upload(impulse);
  known_grip_.upload(grip);
  known_count_.upload({static_cast<std::uint32_t>(count)});
  rolling_.remember(memory, m);
  if (scene_.joints) scene_.joints->remember(memory.joints);
  if (scene_.effects.sleeping) sleeping_.remember(memory.slow);

  if (memory.walls.size() != static_cast<std::size_t>(scene_.surfaces())) return;
  std::vector<Real> walls(wall_impulse_.size(), 0);
  std::vector<Vector3<Real>> wall_grips(wall_grip_.size(), Vector3<Real>::Zero());
  const auto n = static_cast<std::size_t>(scene_.body_count);
  for (std::size_t p = 0; p < memory.walls.size(); ++p) {
    const std::size_t known = memory.walls[p].size();
    for (std::size_t body = 0; body < std::min(n, known); ++body) {
      walls[p * n + body] = static_cast<Real>(memory.walls[p][body]);
      if (!wall_grips.empty() && !memory.wall_grips.empty())
        wall_grips[p * n + body] = narrowed<Real>(memory.wall_grips[p * known + body]);
    }
  }
  wall_impulse_.upload(walls);
  wall_grip_.upload(wall_grips);
  ask_all_walls();
}

/// Before the first step that may find any of them.
template <class Real>
void SoftStepSolver<Real>::ask_all_walls() {
  const auto bodies = static_cast<std::size_t>(scene_.surfaces() > 0 ? scene_.body_count : 0);
  wall_at_.upload(std::vector<std::uint32_t>(bodies, ~std::uint32_t{0}));
}

template <class Real>
void SoftStepSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  with_effect<&Effects::friction>(scene_.effects,
                                  [&]<bool rubbed>() { advance<rubbed>(contacts, impulses); });
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::advance(const ContactView<Real>& contacts, Real* impulses) {
  prescribed_.begin();
  if constexpr (built_effects.sleeping)
    if (scene_.effects.sleeping)
      sleeping_.find_islands(contacts, contact_capacity_,
                             scene_.joints ? scene_.joints->view() : JointView<Real>{});
  prepare<rubbed>(contacts);
  if constexpr (built_effects.continuous_collision)
    if (scene_.effects.continuous_collision) continuous_.begin(scene_.time_step, scene_.slack);
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    free_motion_.begin();
    if constexpr (built_effects.rolling_resistance)
      if (scene_.effects.rolling_resistance) rolling_.warm_start(rolling_source());
    begin_substep<rubbed>();
    prescribed_.hold();
    if constexpr (built_effects.joints)
      if (scene_.effects.joints) scene_.joints->warm_start();
    record_sweep<rubbed, true>(substep, 0);
    for (int sweeps = 1; sweeps <= scene_.iterations; ++sweeps) {
      if constexpr (built_effects.joints)
        if (scene_.effects.joints) scene_.joints->solve();
      with_effect<&Effects::continuous_collision>(scene_.effects, [&]<bool held>() {
        sweep("solve", Solve<Real, held>{scene_.bodies.radius, softness_});
      });
      sweep_walls<rubbed>("solve", false, false);
      record_sweep<rubbed, true>(substep, sweeps);
    }
    move();
    prescribed_.hold(h_);
    run_awake_contacts(executor_, "relax", Count(&scene_.control->contacts, contact_capacity_), swept_.data(),
                       sleeping_.asleep(), PlaceContacts<Real>{swept_.data(), scene_.bodies, soft_.data()});
    record_sweep<rubbed, false>(substep, 0);
    for (int sweeps = 1; sweeps <= scene_.iterations; ++sweeps) {
      const bool last = sweeps == scene_.iterations;
      if constexpr (built_effects.joints)
        if (scene_.effects.joints) scene_.joints->relax();
      sweep_walls<rubbed>("relax", true, last);
      sweep("relax", Relax<Real, rubbed>{softness_, scene_.bodies.radius, last, scene_.restitution,
                                         last && substep + 1 == scene_.substeps ? bounces_.data() : nullptr});
      if constexpr (built_effects.rolling_resistance)
        if (scene_.effects.rolling_resistance) rolling_.resist(rolling_source());
      record_sweep<rubbed, false>(substep, sweeps);
    }
  }
  on_walls<rubbed>([&]<bool boxed>(const SoftWalls<Real, rubbed, boxed>& walls) {
    run_bodies("bounce", BounceOffWalls<Real, rubbed, boxed>{walls, scene_.control});
  });
  sweep("bounce", Bounce<Real>{scene_.restitution, bounces_.data()});
  if constexpr (rubbed) {
    on_walls<true>([&]<bool boxed>(const SoftWalls<Real, true, boxed>& walls) {
      run_bodies("friction", GripWalls<Real, boxed>{walls, scene_.control});
    });
    sweep("friction", Grip<Real>{bounces_.data()});
  }
  prescribed_.hold();
  keep<rubbed>(contacts, impulses);
  if constexpr (built_effects.sleeping)
    if (scene_.effects.sleeping) sleeping_.count();
}

template <class Real>
template <class Stage>
void SoftStepSolver<Real>::run_bodies(const char* name, const Stage& stage) {
  run_awake_bodies(executor_, name, scene_.body_count, sleeping_.asleep(), stage);
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::prepare(const ContactView<Real>& contacts) {
  StepControl* control = scene_.control;
  colouring_.colour(contacts.bodies, control, sleeping_.asleep());
  const ColourView colours = colouring_.view();
  const ImpulseView<Real> known{known_contacts_.data(), known_impulse_.data(), known_count_.data()};
  executor_.run("prepare", Count(&control->contacts, contact_capacity_),
                PrepareContacts<Real, rubbed>{contacts.bodies, scene_.bodies, known,
                                              KnownGrips<Real>{scene_.friction, known_grip_.data()}, colours,
                                              place_of_.data(), swept_.data(), inverse_masses_.data(),
                                              turns_.data(), grips_.data(), gripped_.data(), soft_.data()});
  const ContactSet all{contacts.bodies, nullptr, nullptr, &control->contacts};
  all_.list("prepare", all, colouring_.degrees(), place_of_.data());
  const ContactSet split{contacts.bodies, colours.order, colours.begin + Colouring::colours,
                         &control->split_contacts};
  split_degrees_.count("prepare", split);
  split_.list("prepare", split, split_degrees_, place_of_.data());
  if constexpr (built_effects.rolling_resistance)
    if (scene_.effects.rolling_resistance) rolling_.prepare(rolling_source(), known);
}

template <class Real>
RollingSource<Real> SoftStepSolver<Real>::rolling_source() const {
  return {swept_.data(),
          soft_.data(),
          place_of_.data(),
          all_.view(colouring_.degrees()),
          Count(&scene_.control->contacts, contact_capacity_),
          wall_impulse_.data(),
          sleeping_.asleep()};
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::begin_substep() {
  if constexpr (built_effects.attractor)
    if (scene_.effects.attractor)
      executor_.run("attractor", scene_.body_count,
                    PullBodies<Real>{scene_.attractors, scene_.bodies.position, scene_.field});
  if constexpr (built_effects.drag)
    if (scene_.effects.drag)
      run_bodies("drag", DragBodies<Real>{scene_.bodies, scene_.drag, scene_.gravity, scene_.field, h_,
                                          scene_.control});
  const auto with = [&]<Pull pull, bool walled, bool boxed>() {
    run_bodies("forces",
               BeginSubstep<Real, pull, walled, rubbed, boxed>{
                   scene_.bodies, swept_.data(), soft_.data(), grips_.data(), all_.view(colouring_.degrees()),
                   walls<rubbed, boxed>(), scene_.gravity, scene_.field, h_, scene_.control});
  };
  const auto with_walls = [&]<Pull pull>() {
    if (scene_.boxes.count > 0)
      with.template operator()<pull, true, true>();
    else if (scene_.plane_count > 0)
      with.template operator()<pull, true, false>();
    else
      with.template operator()<pull, false, false>();
  };
  with_effect<&Effects::attractor>(scene_.effects, [&]<bool field>() {
    // Both are named by the parameter, so that a build without the effect does not compile them.
    if constexpr (field)
      with_walls.template operator()<field ? Pull::field : Pull::none>();
    else
      with_effect<&Effects::gravity>(scene_.effects, [&]<bool gravity>() {
        with_walls.template operator()<gravity ? Pull::uniform : Pull::none>();
      });
  });
}

template <class Real>
void SoftStepSolver<Real>::move() {
  free_motion_.fly(h_, true);
  if constexpr (built_effects.continuous_collision)
    if (scene_.effects.continuous_collision)
      continuous_.hold(free_motion_.ways(), swept_.data(), contact_capacity_, h_);
  free_motion_.move(h_, true, sleeping_.asleep(), continuous_.motion());
}

template <class Real>
template <bool rubs>
SweptContacts<Real, rubs> SoftStepSolver<Real>::swept() const {
  const ColourView colours = colouring_.view();
  return {swept_.data(),
          inverse_masses_.data(),
          soft_.data(),
          grips_.data(),
          gripped_.data(),
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
template <bool rubbed, bool soft>
void SoftStepSolver<Real>::record_sweep(int substep, int sweep) {
  if (!residuals_.on()) return;
  constexpr bool rubs = rubbed && !soft;
  const int sums = scene_.iterations + 1, place = (2 * substep + (soft ? 0 : 1)) * sums + sweep;
  const auto with = [&]<bool boxed>() {
    residuals_.record(place, scene_.body_count + contact_capacity_,
                      SoftResidual<Real, soft, rubbed, boxed>{
                          walls<rubbed, boxed>(), swept<rubs>(), softness_, sleeping_.asleep(),
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
template <bool rubbed, bool boxed>
SoftWalls<Real, rubbed, boxed> SoftStepSolver<Real>::walls() const {
  return {scene_.bodies,
          scene_.body_count,
          scene_.planes,
          scene_.plane_count,
          scene_.restitution,
          scene_.gravity,
          softness_.inverse_h,
          wall_impulse_.data(),
          wall_bounce_.data(),
          wall_at_.data(),
          WallGrips<Real>{scene_.friction, wall_grip_.data(), wall_grip_total_.data(), wall_pressed_.data()},
          BoxContacts<Real>{scene_.boxes, box_face_.data(), box_touched_.data()},
          scene_.ledger};
}

template <class Real>
template <bool rubbed, class With>
void SoftStepSolver<Real>::on_walls(const With& with) {
  if (scene_.boxes.count > 0)
    with(walls<rubbed, true>());
  else if (scene_.plane_count > 0)
    with(walls<rubbed, false>());
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::sweep_walls(const char* stage, bool relaxing, bool last) {
  on_walls<rubbed>([&]<bool boxed>(const SoftWalls<Real, rubbed, boxed>& walls) {
    run_bodies(stage, SolveWalls<Real, rubbed, boxed>{walls, relaxing, last, scene_.control});
  });
}

template <class Real>
template <bool rubbed>
void SoftStepSolver<Real>::keep(const ContactView<Real>& contacts, Real* impulses) {
  const auto with = [&]<bool record>() {
    executor_.run("keep", Count(&scene_.control->contacts, contact_capacity_),
                  KeepContacts<Real, rubbed, record>{contacts.bodies, place_of_.data(), soft_.data(),
                                                     grips_.data(), known_grip_.data(), impulses,
                                                     known_contacts_.data(), known_impulse_.data()});
  };
  impulses != nullptr ? with.template operator()<true>() : with.template operator()<false>();
  if constexpr (built_effects.rolling_resistance)
    if (scene_.effects.rolling_resistance) rolling_.keep(rolling_source());
  executor_.run("keep", 1, EndStep{scene_.control, known_count_.data(), bounces_.data()});
}

template class SoftStepSolver<float>;
template class SoftStepSolver<double>;

}  // namespace collidoscope
