#include "sim_cuda/accuracy/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim_cuda/accuracy/errors.h"
#include "sim_cuda/accuracy/settings.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/core/statistics.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

std::vector<double> heights_of(const BodyStates& states, const Scene& scene) {
  const Vector3d& g = scene.physics.gravity;
  const Vector3d up = g.norm() > 0 ? Vector3d(-g / g.norm()) : Vector3d(0, 0, 1);
  std::vector<double> heights;
  for (const Vector3d& x : states.position) heights.push_back(up.dot(x));
  return heights;
}

std::vector<double> speeds_of(const BodyStates& states) {
  std::vector<double> speeds;
  for (const Vector3d& v : states.velocity) speeds.push_back(v.norm());
  return speeds;
}

/// The finest two settings of each refinement series in double. They should converge to the reference.
std::map<std::string, std::vector<std::size_t>> finest_of_series(const std::vector<AccuracyPoint>& points,
                                                                 const AccuracyProblem& problem) {
  std::map<std::string, std::vector<std::size_t>> all_series;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (points[k].setting.precision == Precision::f64 && in_refinement_series(points[k], problem))
      all_series[points[k].series_name].push_back(k);
  for (auto& [series_name, series] : all_series) {
    std::ranges::sort(series, std::greater<>(), [&](std::size_t k) { return points[k].setting.time_step; });
    if (series.size() > 2) series.erase(series.begin(), series.end() - 2);
  }
  return all_series;
}

}  // namespace

struct AccuracyStudy::ErrorRun {
  SampledRun run;
  InvariantCollector invariants;
  ErrorSum error;
};

AccuracyStudy::AccuracyStudy(const Scene& scene, const RunOptions& options, AccuracyStudyOptions request,
                             const RunState* start)
    : request_(std::move(request)), problem_(make_accuracy_problem(scene, options, request_.seconds, start)) {
  const std::vector<Motion>& motion = problem_.initial.motion;
  if (problem_.initial.size() == 0 ||
      (!motion.empty() && std::ranges::none_of(motion, [](Motion m) { return m == Motion::dynamic; })))
    throw InputError((scene.file.empty() ? scene.name : scene.file) +
                     ": no dynamic body; errors can be measured only for dynamic bodies");
  if (request_.reference_scene)
    reference_problem_ = make_accuracy_problem(*request_.reference_scene, options, request_.seconds, start);
  reference_run_ = std::make_unique<ReferenceRun>(reference_problem_ ? *reference_problem_ : problem_);
}
AccuracyStudy::~AccuracyStudy() = default;

bool AccuracyStudy::advance(double milliseconds) {
  const Deadline slice(milliseconds);
  do {
    if (reference_run_) {
      if (!reference_run_->advance(slice)) plan();
    } else if (next_ < jobs_.size()) {
      const bool ended = jobs_[next_].round < 0 ? measure_error(slice) : measure_cost(slice);
      if (ended) ++next_;
      if (next_ == jobs_.size()) check_convergence();
    }
  } while (!slice.passed() && !done());
  return !done();
}

AccuracyStudy::Progress AccuracyStudy::progress() const {
  if (reference_run_)
    return {static_cast<std::int64_t>(1000 * reference_run_->progress()), 1000,
            reference_run_->current_task()};
  Progress progress{static_cast<std::int64_t>(next_), static_cast<std::int64_t>(jobs_.size()), "done"};
  if (next_ < jobs_.size()) {
    const AccuracyPoint& point = points_[jobs_[next_].point];
    progress.current_task = fmt::format("{} of {}, {}", jobs_[next_].round < 0 ? "error" : "timing",
                                        point.series_name, point.name);
  }
  return progress;
}

AccuracyRecord AccuracyStudy::record() const {
  const AccuracyProblem& s = problem_;
  std::uint64_t hash = 0;
  const auto mix = [&](std::uint64_t word) { hash = mix64(hash ^ word); };
  for (const char letter : write_scene(s.scene) + s.executor + s.options.broad_phase)
    mix(static_cast<unsigned char>(letter));
  for (const std::vector<Vector3d>* vectors : {&s.start.bodies.position, &s.start.bodies.velocity})
    for (const Vector3d& v : *vectors)
      for (int k = 0; k < 3; ++k) mix(hash_bits(v[k]));
  mix(hash_bits(s.coarsest * s.stride * s.samples));
  for (const int number : {request_.rounds, s.options.shape.blocks, s.options.shape.threads})
    mix(static_cast<std::uint64_t>(number));
  return {s.scene.name,
          s.executor,
          fmt::format("{:016x}", hash),
          std::ssize(s.start.bodies.position),
          request_.rounds,
          done(),
          reference_,
          points_,
          warnings_};
}

bool AccuracyStudy::restore(const AccuracyRecord& known) {
  if (known.physics_version != physics_version || known.problem_hash != record().problem_hash) return false;
  recorded_points_ = known.points;
  return true;
}

/// Lists the remaining jobs: each setting's error and first cost, from coarse to fine, then the other costs
/// in rounds.
void AccuracyStudy::plan() {
  reference_ = reference_run_->result();
  samples_ = reference_run_->take_samples();
  horizon_ = reference_run_->horizon();
  points_ = request_.settings ? *request_.settings : accuracy_settings(problem_, reference_run_->fastest());
  reference_run_.reset();
  scales_ = InvariantScales(samples_, problem_.initial);
  for (AccuracyPoint& point : points_)
    for (AccuracyPoint& known : recorded_points_)
      if (known.series_name == point.series_name && known.name == point.name &&
          known.setting == point.setting)
        point = known;
  recorded_points_.clear();
  mark_front(points_);
  std::map<std::size_t, bool> again;  // points to measure again, because records contain no states
  for (const auto& [series_name, series] : finest_of_series(points_, problem_))
    for (const std::size_t k : series) again[k] = true;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (!points_[k].has_error() || again.contains(k)) jobs_.push_back({k, -1});
    if (points_[k].ms_runs.empty()) jobs_.push_back({k, 0});
  }
  for (int round = 1; round < request_.rounds; ++round)
    for (std::size_t k = 0; k < points_.size(); ++k)
      if (std::ssize(points_[k].ms_runs) <= round) jobs_.push_back({k, round});
}

bool AccuracyStudy::measure_error(const Deadline& slice) {
  if (!error_run_) {
    error_run_.reset(new ErrorRun{
        {problem_, points_[jobs_[next_].point].setting, problem_.start}, {problem_, scales_}, {}});
    error_run_->invariants.add_sample(error_run_->run.world(), 0, &samples_[0].stats);
  }
  if (!error_run_->run.reach_next(slice)) return false;
  compare_sample();
  if (error_run_->run.sample() + 1 < std::ssize(samples_)) return false;
  finish_error();
  return true;
}

void AccuracyStudy::compare_sample() {
  const int sample = error_run_->run.sample();
  const ReferenceSample& expected = samples_[static_cast<std::size_t>(sample)];
  World& world = error_run_->run.world();
  error_run_->invariants.add_sample(world, problem_.time(sample), &expected.stats);
  if (sample > horizon_) return;
  const BodyStates states = world.bodies();
  error_run_->error.add(
      squared_distances(states, expected.bodies, problem_.initial, problem_.effects.rotation));
  if (sample == horizon_ && points_[jobs_[next_].point].setting.precision == Precision::f64)
    at_horizon_[jobs_[next_].point] = states;
}

void AccuracyStudy::finish_error() {
  AccuracyPoint& point = points_[jobs_[next_].point];
  const ErrorSum::Result error = error_run_->error.result(problem_.initial);
  point.error = error.rms;
  point.error_low = error.low;
  point.error_high = error.high;
  point.error_worst = error.worst;
  point.invariants = error_run_->invariants.result();
  const BodyStates states = error_run_->run.world().bodies();
  point.distributions = {distribution_distance(heights_of(states, problem_.scene),
                                               heights_of(samples_.back().bodies, problem_.scene)),
                         distribution_distance(speeds_of(states), speeds_of(samples_.back().bodies))};
  error_run_.reset();
  mark_front(points_);
}

bool AccuracyStudy::measure_cost(const Deadline& slice) {
  AccuracyPoint& point = points_[jobs_[next_].point];
  if (!cost_run_) {
    cost_run_ = std::make_unique<SampledRun>(problem_, point.setting, problem_.start);
    cost_run_->world().step(2);  // warm-up: buffers grow, code and caches are loaded
    cost_run_->restart(problem_.start);
  }
  if (!cost_run_->reach_next(slice)) return false;
  if (cost_run_->sample() + 1 < std::ssize(samples_)) return false;
  // Runs with few steps are repeated until there are enough steps for a median.
  constexpr int enough = 100;
  cost_steps_ += cost_run_->plain_steps();
  costs_.push_back(cost_run_->cost_ms_per_second());
  if (cost_steps_ < enough) {
    cost_run_->restart(problem_.start);
    return false;
  }
  point.ms_runs.push_back(quantile(costs_, 0.5, not_known));
  costs_.clear();
  cost_steps_ = 0;
  point.ms = {quantile(point.ms_runs, 0.5, not_known), quantile(point.ms_runs, 0.25, not_known),
              quantile(point.ms_runs, 0.75, not_known)};
  cost_run_.reset();
  mark_front(points_);
  return true;
}

/// Warns if the finest runs of a series agree with each other but not with the reference. Either the
/// reference or the solver is then wrong.
void AccuracyStudy::check_convergence() {
  for (const auto& [series_name, series] : finest_of_series(points_, problem_)) {
    if (series.size() < 2 || !at_horizon_.contains(series[0]) || !at_horizon_.contains(series[1])) continue;
    const BodyStates &coarse = at_horizon_[series[0]], &fine = at_horizon_[series[1]];
    const auto from = [&](const BodyStates& other) {
      return rms_distance(fine, other, problem_.initial, problem_.effects.rotation);
    };
    const double off = from(samples_[static_cast<std::size_t>(horizon_)].bodies), apart = from(coarse);
    if (off > 4 * apart + 4 * reference_.error)
      warnings_.push_back(
          fmt::format("{}: the results of the last two time steps differ by {:.2g} m, but by {:.2g} m from "
                      "the reference: this series converges to another solution",
                      series_name, apart, off));
  }
  at_horizon_.clear();
}

}  // namespace collidoscope
