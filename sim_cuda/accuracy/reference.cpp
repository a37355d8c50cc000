#include "sim_cuda/accuracy/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim_cuda/accuracy/errors.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/philox.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

constexpr double most_growth = 1000;
constexpr int runs = 4;
constexpr double weights[runs] = {1, 1, 2, 4};  // relative amounts of work

/// The start state with every body displaced by `share` of its radius in a random direction.
RunState perturbed(const RunState& start, const InitialBodies& bodies, double share) {
  RunState moved = start;
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    const PhiloxWords words = philox4x32({{i, 0, 0, 0}}, philox_key(1));
    const auto part = [&](int k) { return 2.0 * static_cast<double>(unit_float(words.w[k])) - 1; };
    const Vector3d direction(part(0), part(1), part(2));
    const double size = direction.norm();
    moved.bodies.position[i] += share * bodies.radius[i] * (size > 0 ? direction / size : Vector3d(0, 0, 1));
  }
  return moved;
}

/// The scene with its bodies listed individually in the start state, as HardSpheres requires.
Scene listed(const AccuracyProblem& problem, const RunState& start) {
  Scene scene = problem.scene;
  const InitialBodies& bodies = problem.initial;
  scene.physics.effects = problem.effects;
  scene.generators.clear();
  scene.body_files.clear();
  scene.extra_bodies.clear();
  scene.bodies.clear();
  scene.box = bodies.box;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = scene.bodies.emplace_back();
    body.motion = bodies.motion.empty() ? Motion::dynamic : bodies.motion[i];
    body.radius = bodies.radius[i];
    body.mass = bodies.mass[i];
    body.position = start.bodies.position[i];
    body.velocity = start.bodies.velocity[i];
    body.material = bodies.material.empty() ? 0 : bodies.material[i];
  }
  return scene;
}

/// The setting with the most accurate integrator and rotation update that the scene supports.
AccuracySetting best_integrated(const AccuracyProblem& problem, const AccuracySetting& setting) {
  AccuracySetting best = setting;
  for (const auto& integrator : integrator_names)
    for (const auto& rotation : rotation_update_names) {
      AccuracySetting other = setting;
      other.integrator = integrator.value;
      other.rotation_update = rotation.value;
      if (validate(with_setting(problem.scene, other, problem.effects)).empty()) best = other;
    }
  return best;
}

}  // namespace

ReferenceRun::ReferenceRun(const AccuracyProblem& problem) : problem_(problem) { begin_spheres(); }
ReferenceRun::~ReferenceRun() = default;

double ReferenceRun::distance(const BodyStates& a, const BodyStates& b) const {
  return rms_distance(a, b, problem_.initial, problem_.effects.rotation);
}

bool ReferenceRun::advance(const Deadline& slice) {
  do
    if (exact_ ? !advance_spheres(slice) : !advance_runs(slice)) break;
  while (!done_ && !slice.passed());
  return !done_;
}

double ReferenceRun::progress() const {
  if (done_) return 1;
  double done = 0, all = 0;
  for (int k = 0; k < runs; ++k) {
    all += weights[k];
    if (k < runs_done_) done += weights[k];
    if (k == runs_done_ && run_) done += weights[k] * run_->sample() / problem_.samples;
  }
  return done / all;
}

// ---- Event-driven ----

void ReferenceRun::begin_spheres() {
  current_task_ = "reference: event-driven hard spheres";
  if (!problem_.initial.meshes.empty()) return begin_runs("meshes");
  try {
    const Scene scene = listed(problem_, problem_.start);
    exact_ = std::make_unique<HardSpheres>(scene);
    perturbed_ =
        std::make_unique<HardSpheres>(listed(problem_, perturbed(problem_.start, problem_.initial, 1e-10)));
    samples_.push_back({exact_->bodies(), exact_->measure()});
  } catch (const InputError& error) {
    exact_.reset();
    const std::string& line = error.lines().front();
    begin_runs(line.substr(line.find(": ") == std::string::npos ? 0 : line.find(": ") + 2));
  }
}

bool ReferenceRun::advance_spheres(const Deadline& slice) {
  const auto next = static_cast<int>(samples_.size());
  if (next > problem_.samples) {
    finish_spheres();
    return true;
  }
  const double time = problem_.time(next);
  while (exact_->next_collision(time) && !exact_->zeno_point())
    if (slice.passed()) return false;
  if (!exact_->advance_to(time)) {
    finish_spheres();
    return true;
  }
  samples_.push_back({exact_->bodies(), exact_->measure()});
  fastest_ = std::max(fastest_, samples_.back().stats.max_speed);
  return true;
}

void ReferenceRun::finish_spheres() {
  const int reached = static_cast<int>(samples_.size()) - 1;
  if (3 * reached < problem_.samples) {
    const std::string zeno = exact_->zeno_line();
    exact_.reset();
    perturbed_.reset();
    samples_.clear();
    return begin_runs(zeno);
  }
  result_.kind = AccuracyReference::Kind::hard_spheres;
  result_.description = fmt::format("event-driven hard spheres, {} collisions",
                                    exact_->counts().pairs + exact_->counts().planes);
  result_.end = exact_->zeno_line();
  result_.seconds = problem_.time(reached);
  horizon_ = reached;
  const double first = distance(perturbed_->bodies(), samples_[0].bodies);
  std::vector<BodyStates> other;
  std::vector<const BodyStates*> same;
  for (int k = 1; k <= reached && perturbed_->advance_to(problem_.time(k)); ++k) {
    other.push_back(perturbed_->bodies());
    same.push_back(&samples_[static_cast<std::size_t>(k)].bodies);
  }
  const double growth = measure_growth(other, same, first);
  double extent = 0;
  for (const Vector3d& x : samples_[0].bodies.position) extent = std::max(extent, x.norm());
  result_.error = 4e-16 * extent * std::max(growth, 1.0);
  exact_.reset();
  perturbed_.reset();
  done_ = true;
}

// ---- Converged ----

void ReferenceRun::begin_runs(const std::string& why) {
  result_.kind = AccuracyReference::Kind::converged_run;
  result_.description = why;  // completed in finish_runs()
  setting_ = problem_.own_setting();
  setting_.solver = Solver::soft_step;
  setting_.precision = Precision::f64;
  setting_.time_step = problem_.coarsest / 32;
  setting_.substeps = problem_.scene.physics.solver == Solver::impulse ? 4 : problem_.substeps;
  setting_ = best_integrated(problem_, setting_);
  perturbed_start_ = perturbed(problem_.start, problem_.initial, 1e-8);
  current_task_ = "reference: converged run, step h";
}

bool ReferenceRun::advance_runs(const Deadline& slice) {
  static constexpr const char* names[runs] = {"h", "h, perturbed start", "h/2", "h/4"};
  if (runs_done_ == runs) {
    finish_runs();
    return true;
  }
  const auto k = static_cast<std::size_t>(runs_done_);
  if (!run_) {
    current_task_ = fmt::format("reference: converged run, step {}", names[k]);
    AccuracySetting setting = setting_;
    setting.time_step /= k == 3 ? 4 : k == 2 ? 2 : 1;
    run_ = std::make_unique<SampledRun>(problem_, setting, k == 1 ? perturbed_start_ : problem_.start);
    if (k == 3) samples_.push_back({run_->world().bodies(), run_->world().measure()});
  }
  if (!run_->reach_next(slice)) return false;
  BodyStates bodies = run_->world().bodies();
  if (k == 3) {
    samples_.push_back({std::move(bodies), run_->world().measure()});
    fastest_ = std::max(fastest_, samples_.back().stats.max_speed);
  } else {
    (k == 0 ? first_ : k == 1 ? second_ : third_).push_back(std::move(bodies));
  }
  if (run_->sample() < problem_.samples) return true;
  run_.reset();
  ++runs_done_;
  return true;
}

void ReferenceRun::finish_runs() {
  const std::string why = result_.description;
  horizon_ = problem_.samples;
  result_.seconds = problem_.time(horizon_);
  // Differences at the level of rounding do not count as missing convergence.
  double extent = 0;
  for (const Vector3d& x : samples_[0].bodies.position) extent = std::max(extent, x.norm());
  const double rounding = 1e-13 * std::max(extent, 1e-3);
  std::vector<double> d1, d2;
  for (int k = 1; k <= problem_.samples; ++k) {
    const auto at = static_cast<std::size_t>(k);
    d1.push_back(distance(first_[at - 1], third_[at - 1]));
    d2.push_back(distance(third_[at - 1], samples_[at].bodies));
    if (!(d2.back() < 0.71 * d1.back()) && !(d2.back() < rounding)) {
      horizon_ = k - 1;
      result_.end = fmt::format("runs with steps of {:.3g} s and half of it diverge at {:.3g} s",
                                setting_.time_step / 2, problem_.time(k));
      break;
    }
  }
  horizon_ = std::max(horizon_, 1);  // at least one sample is compared; the reference's error states its
                                     // quality
  std::vector<const BodyStates*> same;
  for (const BodyStates& each : first_) same.push_back(&each);
  measure_growth(second_, same, distance(perturbed_start_.bodies, problem_.start.bodies));
  double coarse = 0, fine = 0;
  for (int k = 0; k < horizon_; ++k) {
    coarse += d1[static_cast<std::size_t>(k)] * d1[static_cast<std::size_t>(k)] / horizon_;
    fine += d2[static_cast<std::size_t>(k)] * d2[static_cast<std::size_t>(k)] / horizon_;
  }
  result_.order = fine > rounding * rounding ? std::log2(coarse / fine) / 2 : not_known;
  const double order = std::isfinite(result_.order) ? std::clamp(result_.order, 0.5, 4.0) : 1;
  result_.error = std::max(std::sqrt(fine) / (std::exp2(order) - 1), rounding);
  result_.description = fmt::format("converged run in double precision, {} s in {} substeps ({})",
                                    fmt::format("{:.3g}", setting_.time_step / 4), setting_.substeps,
                                    why.empty() ? "no event-driven reference" : "not event-driven: " + why);
  first_.clear();
  second_.clear();
  third_.clear();
  done_ = true;
}

double ReferenceRun::measure_growth(const std::vector<BodyStates>& other,
                                    const std::vector<const BodyStates*>& same, double first) {
  double growth = 1, mean_radius = 0;
  for (const double r : problem_.initial.radius)
    mean_radius += r / static_cast<double>(problem_.initial.size());
  for (std::size_t k = 0; k < other.size() && first > 0; ++k) {
    const int sample = static_cast<int>(k) + 1;
    const double grown = distance(other[k], *same[k]) / first;
    if (k == 0 || grown * first < 0.01 * mean_radius)  // growth saturates later
      result_.lyapunov_rate = std::log(grown) / problem_.time(sample);
    if (sample <= horizon_) growth = grown;
    if (!(grown > most_growth) || sample > horizon_) continue;
    horizon_ = std::max(sample - 1, 1);
    result_.end =
        fmt::format("a small perturbation has grown {:.3g}-fold at {:.3g} s", grown, problem_.time(sample));
    break;
  }
  result_.horizon = problem_.time(horizon_);
  return growth;
}

}  // namespace collidoscope
