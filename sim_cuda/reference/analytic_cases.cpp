#include "sim_cuda/reference/analytic_cases.h"

#include "sim_cuda/core/assets.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

Scene analytic_scene(const std::string& name) {
  return read_scene(asset("scenes/analytic/" + name + ".json").string());
}

std::vector<AnalyticCase> analytic_cases() {
  std::vector<AnalyticCase> all = smooth_cases();
  for (const auto& more : {impact_cases(), contact_cases()}) all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace collidoscope
