#include "sim_cuda/accuracy/point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace collidoscope {

AccuracySetting accuracy_setting(const Physics& physics, int substeps, const Effects& effects) {
  return {.time_step = physics.time_step,
          .substeps = substeps,
          .iterations = physics.iterations,
          .solver = physics.solver,
          .integrator = physics.integrator,
          .rotation_update = physics.rotation_update,
          .precision = physics.precision,
          .continuous_collision = effects.continuous_collision};
}

SettingsPatch patch_of(const AccuracySetting& setting) {
  TimeStep step = setting.time_step;
  const double rate = std::round(1 / setting.time_step);
  if (rate >= 1 && rate <= 1e6 && 1 / rate == setting.time_step)
    step = TimeStep::per_second(static_cast<int>(rate));
  return SettingsPatch()
      .set<&Physics::time_step>(step)
      .set<&Physics::substeps>(setting.substeps)
      .set<&Physics::iterations>(setting.iterations)
      .set<&Physics::solver>(setting.solver)
      .set<&Physics::integrator>(setting.integrator)
      .set<&Physics::rotation_update>(setting.rotation_update)
      .set<&Physics::precision>(setting.precision);
}

Scene with_setting(const Scene& scene, const AccuracySetting& setting, const Effects& effects) {
  Scene changed = scene;
  apply(patch_of(setting), changed);
  changed.physics.effects = effects;
  changed.physics.effects->continuous_collision = setting.continuous_collision;
  return changed;
}

void mark_front(std::vector<AccuracyPoint>& points) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < points.size(); ++k) {
    points[k].on_front = false;
    if (points[k].has_error() && points[k].has_cost()) order.push_back(k);
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const double ms_a = points[a].ms.median, ms_b = points[b].ms.median;
    return ms_a != ms_b ? ms_a < ms_b : points[a].error < points[b].error;
  });
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t k : order) {
    points[k].on_front = points[k].error < least;
    least = std::min(least, points[k].error);
  }
}

std::optional<std::size_t> cheapest_below(std::span<const AccuracyPoint> points, double tolerance) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const AccuracyPoint& p = points[k];
    if (!p.has_cost() || !(p.error <= tolerance)) continue;
    if (!best || p.ms.median < points[*best].ms.median) best = k;
  }
  return best;
}

bool all_below_reference(std::span<const AccuracyPoint> points, double reference_error) {
  bool any = false;
  for (const AccuracyPoint& p : points) {
    if (!p.has_error()) continue;
    if (!(p.error <= reference_error)) return false;
    any = true;
  }
  return any;
}

Recommendation recommended(std::span<const AccuracyPoint> points, double reference_error, double tolerance) {
  if (all_below_reference(points, reference_error))
    return {std::nullopt,
            fmt::format(
                "no setting can be recommended: all errors are below the error of the reference, {:.3g} m",
                reference_error)};
  if (tolerance < reference_error)
    return {std::nullopt, fmt::format("no setting can be recommended: the allowed error of {:.3g} m is below "
                                      "the error of the reference, {:.3g} m",
                                      tolerance, reference_error)};
  if (const auto best = cheapest_below(points, tolerance)) return {best, ""};
  double least = std::numeric_limits<double>::infinity();
  for (const AccuracyPoint& p : points)
    if (p.error < least) least = p.error;
  if (!std::isfinite(least)) return {std::nullopt, "no setting has been measured yet"};
  return {std::nullopt,
          fmt::format("no setting has an error of at most {:.3g} m; the smallest error is {:.3g} m",
                      tolerance, least)};
}

}  // namespace collidoscope
