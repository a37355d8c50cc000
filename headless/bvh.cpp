#include "headless/bvh.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "headless/bvh_boxes.h"
#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/report.h"
#include "headless/tree_table.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Json = nlohmann::ordered_json;

MeasuredTree measure_tree_of(World& world, int repeats) {
  MeasuredTree m;
  m.method = world.options().broad_phase;
  m.key_bits = world.info().key_bits;
  m.quality = world.tree().quality();
  m.take(world.tree().time_broad_phase(repeats));
  return m;
}

}  // namespace

int bvh_command(const CommandLine& line) {
  const Options& options = line.options;
  if (!options.bench.boxes.empty()) return bvh_of_boxes(options);
  if (!options.bench.tree.empty())
    throw InputError("--tree: needs the boxes of its leaves, expected --boxes FILE.npy");
  const Scene scene = load_scene(line);
  std::optional<OutputFile> file;
  if (!options.json.empty() && options.json != "-") file.emplace("--json", options.json);
  const std::vector<std::string> methods =
      options.bench.methods.empty() ? broad_phase_names(options.run.executor) : options.bench.methods;

  std::vector<MeasuredTree> trees;
  std::optional<World> first;  // makes the steps; the other worlds start from its state
  std::string device;
  std::size_t bodies = 0;
  Progress progress("methods", std::ssize(methods));
  for (std::int64_t k = 0; k < std::ssize(methods); ++k) {
    RunOptions run = options.run;
    run.broad_phase = methods[static_cast<std::size_t>(k)];
    World world(scene, run);
    bodies = world.initial().size();
    if (world.tree().nodes() > 0) {
      if (!first) {
        first.emplace(scene, run);
        first->step(static_cast<int>(options.steps_or(0)));
      }
      world.restore(*first);
      trees.push_back(measure_tree_of(world, static_cast<int>(options.bench.repeats)));
      device = world.info().device_name;
    }
    progress.update(k + 1);
  }
  if (trees.empty() && bodies == 0)
    throw InputError(scene.name + ": the scene has no bodies; expected at least one body");
  if (trees.empty())
    throw InputError(fmt::format("{}: no tree to measure with {}; expected a method with a tree", scene.name,
                                 fmt::join(methods, ", ")));
  Json json{
      {"scene", scene.name},     {"physics_version", physics_version}, {"device", device},
      {"state", first->steps()}, {"bodies", trees[0].quality.bodies},  {"pairs", trees[0].quality.pairs},
      {"trees", Json::array()}};
  for (const MeasuredTree& m : trees) json["trees"].push_back(json_of(m));
  if (file) {
    file->write(json_text(json));
    file->commit();
  }
  if (options.json == "-")
    print(json_text(json));
  else
    print(fmt::format("{}: {} bodies, {} pairs of boxes, state {}, on {}\n\n{}", scene.name,
                      grouped(trees[0].quality.bodies), grouped(trees[0].quality.pairs), first->steps(),
                      device, text_of(trees)));
  return 0;
}

}  // namespace collidoscope
