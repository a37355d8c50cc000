#include "sim_cuda/solver/soft_step.h"

#include <algorithm>
#include <type_traits>

#include "sim_cuda/core/block.h"
#include "sim_cuda/core/ordered_sums.h"
#include "sim_cuda/core/whole_record.h"
#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/solver/soft_residual.h"
#include "sim_cuda/solver/soft_sweeps.h"

namespace collidoscope {

namespace {

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
    const bool found = before != KnownContacts::none;
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

/// Forces, the impulses of the substep before, and the first sweep over the planes.
template <class Real, bool rubbed, bool boxed>
struct BeginSubstep {
  BodyView<Real> bodies;
  const StoredContact<Real>* soft;
  ContactsByBodyView by_body;
  SoftWalls<Real, rubbed, boxed> walls;
  Vector3<Real> gravity;       ///< m/s^2
  const Vector3<Real>* field;  ///< m/s^2, of attractors, by body; null where the effect is off
  bool pulled;                 ///< gravity or attractors are on
  Real h;                      ///< s
  const StepControl* control;

  SIM_HD void operator()(int id) const {
    if (control->overflow) return;
    begin(id, Given::over(contacts_of(id), entry(id)));
  }

  SIM_HD bool is_long(int id) const { return !control->overflow && contacts_of(id) > long_list; }
#if defined(__CUDACC__)
  __device__ void together(int id) const {
    const Given given = Given::over_together(contacts_of(id), entry(id));
    if (threadIdx.x == 0) begin(id, given);
  }
#endif

 private:
  /// The impulses of its contacts: momentum, with friction also across the normal, and moment.
  using Given = std::conditional_t<rubbed, OrderedSums<Real, 0, 0, 1>, OrderedSums<Real, 0>>;

  SIM_HD std::uint32_t contacts_of(int id) const { return control->contacts > 0 ? by_body.count[id] : 0; }
  SIM_HD auto entry(int id) const {
    return [this, id, radius = walls.bodies.radius[id]](std::uint32_t k, Vector3<Real>* given) {
      const ContactEnd end = by_body.end(id, k);
      const Real sign = end.sign<Real>();
      const StoredContact<Real> contact = load_whole(&soft[end.contact]);
      given[0] = sign * contact.impulse * contact.normal;
      if constexpr (rubbed) {
        given[1] = sign * contact.rubbed;
        given[2] = -((radius + contact.gap / 2) * contact.normal.cross(contact.rubbed));
      }
    };
  }

  SIM_HD void begin(int id, const Given& given) const {
    typename SoftWalls<Real, rubbed, boxed>::Body body = walls.load(id);
    const Vector3<Real> before = body.v;
    SoftWalls<Real, rubbed, boxed> own = walls;
    if (field != nullptr) own.gravity = gravity + field[id];
    if (pulled) body.v += h * own.gravity;
    if constexpr (boxed) own.face_boxes(id, body);
    own.warm_start(id, body);
    if (contacts_of(id) > 0) {
      body.v += body.inverse_mass * given.sum[0];
      if constexpr (rubbed) body.spin.turn(given.sum[1]);
    }
    own.solve(id, body, false, &before);
    body.given = true;
    walls.store(id, body);
  }
};

/// What the next run starts from.
template <class Real>
struct KeepContacts {
  const Pair* contacts;
  const std::uint32_t* place_of;
  const StoredContact<Real>* soft;
  const ContactSums<Real>* sums;
  Vector3<Real>* known_grip;  ///< null without friction
  Real* total;                ///< N s, of the step; null: not recorded
  Pair* known_contacts;
  std::uint32_t* known_first;
  Real* known_impulse;
  SIM_HD void operator()(int contact) const {
    const auto number = static_cast<std::uint32_t>(contact);
    const std::uint32_t place = place_of[contact];
    const Pair ids = contacts[contact];
    known_contacts[contact] = ids;
    if (KnownContacts::is_first(contacts, number)) known_first[ids.a] = number;
    const StoredContact<Real> kept = load_whole(&soft[place]);
    known_impulse[contact] = kept.impulse;
    if (known_grip != nullptr)
      known_grip[contact] = kept.impulse > 0 ? kept.rubbed : Vector3<Real>(Vector3<Real>::Zero());
    if (total != nullptr) total[contact] = sums[place].total;
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
std::vector<std::array<double, 3>> widened_vectors(const std::vector<Vector3<Real>>& vectors,
                                                   std::size_t count) {
  std::vector<std::array<double, 3>> wide;
  for (std::size_t k = 0; k < count; ++k)
    wide.push_back({static_cast<double>(vectors[k].x()), static_cast<double>(vectors[k].y()),
                    static_cast<double>(vectors[k].z())});
  return wide;
}
template <class Real>
Vector3<Real> narrowed_vector(const std::array<double, 3>& v) {
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
      known_first_(executor, "first contacts of the last step"),
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
  known_first_.upload(std::vector<std::uint32_t>(static_cast<std::size_t>(scene.body_count), 0));
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
  if (!scene.effects.friction) return;
  gripped_.resize_discarding(static_cast<std::size_t>(scene.body_count));
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
  bodies_of_.resize_discarding(m);
  turns_.resize_discarding(m);
  soft_.resize_discarding(m);
  sums_.resize_discarding(m);
  split_change_.resize_discarding(m);
  known_contacts_.resize_keeping(known);
  known_impulse_.resize_keeping(known);
  if (scene_.effects.rolling_resistance) rolling_.reserve(contact_capacity, known);
  if (!scene_.effects.friction) return;
  grips_.resize_discarding(m);
  turned_.resize_discarding(m);
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
  memory.grips = widened_vectors<Real>(known_grip_.download(count), count);
  memory.wall_grips = widened_vectors<Real>(wall_grip_.download(), wall_grip_.size());
  return memory;
}

template <class Real>
void SoftStepSolver<Real>::visit_memory(const ArrayVisit& visit) {
  const std::size_t known = *known_count_.data();
  visit(known_count_.data(), known_count_.bytes());
  visit(known_contacts_.data(), known * sizeof(Pair));
  visit(known_impulse_.data(), known * sizeof(Real));
  if (known_grip_.size() > 0) visit(known_grip_.data(), known * sizeof(Vector3<Real>));
  visit(wall_impulse_.data(), wall_impulse_.bytes());
  visit(wall_grip_.data(), wall_grip_.bytes());
  rolling_.visit_memory(known, visit);
  sleeping_.visit_memory(visit);
  if (scene_.joints) scene_.joints->visit_memory(visit);
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
    if (grips) grip[k] = narrowed_vector<Real>(memory.grips[k]);
  }
  known_contacts_.upload(contacts);
  std::vector<std::uint32_t> first(static_cast<std::size_t>(scene_.body_count), 0);
  for (std::uint32_t k = 0; k < count; ++k)
    if (KnownContacts::is_first(contacts.data(), k)) first[contacts[k].a] = k;
  known_first_.upload(first);
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
        wall_grips[p * n + body] = narrowed_vector<Real>(memory.wall_grips[p * known + body]);
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
  if (scene_.effects.sleeping)
    sleeping_.find_islands(contacts, contact_capacity_,
                           scene_.joints ? scene_.joints->view() : JointView<Real>{});
  prepare(contacts);
  if (scene_.effects.continuous_collision) continuous_.begin(scene_.time_step, scene_.slack);
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    executor_.begin_substep(substep);
    free_motion_.begin();
    if (scene_.effects.rolling_resistance) rolling_.warm_start(rolling_source());
    begin_substep<rubbed>();
    prescribed_.hold();
    if (scene_.effects.joints) scene_.joints->warm_start();
    record_sweep<rubbed>(substep, true, 0);
    for (int sweeps = 1; sweeps <= scene_.iterations; ++sweeps) {
      if (scene_.effects.joints) scene_.joints->solve();
      const Real* held = scene_.effects.continuous_collision ? scene_.bodies.radius : nullptr;
      sweep("solve", Solve<Real>{held, softness_});
      sweep_walls<rubbed>("solve", false, false);
      record_sweep<rubbed>(substep, true, sweeps);
    }
    move();
    prescribed_.hold(h_);
    run_awake_contacts(
        executor_, "relax", Count(&scene_.control->contacts, contact_capacity_), swept_.data(),
        sleeping_.asleep(),
        PlaceContacts<Real>{swept_.data(), bodies_of_.data(), scene_.bodies.position, soft_.data()});
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
  keep(contacts, impulses);
  if (scene_.effects.sleeping) sleeping_.count();
}

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
  const KnownContacts known{known_contacts_.data(), known_count_.data(), known_first_.data()};
  executor_.run("prepare", colouring_.degrees().bodies(),
                FindBodies<Real>{scene_.friction, gripped_.data(), scene_.bodies, found_.data()});
  executor_.run(
      "prepare", Count(&control->contacts, contact_capacity_),
      PrepareContacts<Real>{contacts.bodies, found_.data(), gripped_.data(), known, known_impulse_.data(),
                            known_grip_.data(), colours, place_of_.data(), swept_.data(), bodies_of_.data(),
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
  if (scene_.effects.attractor)
    executor_.run("attractor", scene_.body_count,
                  PullBodies<Real>{scene_.attractors, scene_.bodies.position, scene_.field});
  if (scene_.effects.drag)
    run_bodies("drag", DragBodies<Real>{scene_.bodies, scene_.drag, scene_.gravity, scene_.field, h_,
                                        scene_.control});
  const auto with = [&]<bool boxed>() {
    run_bodies("forces",
               BeginSubstep<Real, rubbed, boxed>{
                   scene_.bodies, soft_.data(), all_.view(colouring_.degrees()), walls<rubbed, boxed>(),
                   scene_.gravity, scene_.effects.attractor ? scene_.field : nullptr,
                   scene_.effects.gravity || scene_.effects.attractor, h_, scene_.control});
  };
  scene_.boxes.count > 0 ? with.template operator()<true>() : with.template operator()<false>();
}

template <class Real>
void SoftStepSolver<Real>::move() {
  free_motion_.fly(h_, true);
  if (scene_.effects.continuous_collision)
    continuous_.hold(free_motion_.ways(), swept_.data(), contact_capacity_, h_);
  free_motion_.move(h_, true, sleeping_.asleep(), continuous_.motion());
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
    residuals_.record(place, scene_.body_count + contact_capacity_,
                      SoftResidual<Real, rubbed, boxed>{walls<rubbed, boxed>(), swept<rubbed>(), softness_,
                                                        soft, sleeping_.asleep(),
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
void SoftStepSolver<Real>::keep(const ContactView<Real>& contacts, Real* impulses) {
  executor_.run(
      "keep", Count(&scene_.control->contacts, contact_capacity_),
      KeepContacts<Real>{contacts.bodies, place_of_.data(), soft_.data(), sums_.data(), known_grip_.data(),
                         impulses, known_contacts_.data(), known_first_.data(), known_impulse_.data()});
  if (scene_.effects.rolling_resistance) rolling_.keep(rolling_source());
  executor_.run("keep", 1, EndStep{scene_.control, known_count_.data(), bounces_.data()});
}

template class SoftStepSolver<float>;
template class SoftStepSolver<double>;

}  // namespace collidoscope
