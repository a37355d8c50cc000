#include "viewer/session/fill_view.h"

#include "sim_cuda/scene/box_collider.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {

void fill_view(World& world, const StepStats& stats, const History& history, WorkspaceView& view) {
  view.scene = world.scene().name;
  view.generated = world.scene().generators.size() == 1;
  view.has_body_file = world.scene().body_files.size() == 1 && !world.scene().body_files[0].boxes;
  view.given_tree = world.initial().tree ? world.scene().body_files[0].tree : "";
  view.active_settings = settings_of(world);
  view.removed_bodies = view.other_bodies = 0;
  if (view.generated) {
    const BoxCollider& generator = world.scene().generators[0];
    view.removed_bodies = std::ssize(generator.excluded);
    view.other_bodies = std::ssize(world.scene().bodies) + std::ssize(world.scene().extra_bodies);
    if (world.scene().box) view.greatest_radius = greatest_radius_max(generator, *world.scene().box);
  }
  const WorldInfo info = world.info();
  view.executor = info.on_gpu ? "CUDA" : "CPU";
  view.device = info.device_name;
  view.tuned = info.tuned;
  view.tuned_rejection = info.tuned_rejection;
  view.broad_phases = broad_phase_names();
  const std::optional<PairCheck> check = world.pair_check();
  view.pairs_note = check ? note_of(*check) : "";
  view.has_wrong_pairs = check && check->is_wrong();
  view.effects = names_of(world.effects());
  view.substeps = world.substeps();
  view.substeps_missed = world.substeps_missed();
  view.key_bits = info.key_bits;
  view.stats = stats;
  view.time = world.time();
  view.allocated_bytes = info.allocated_bytes;
  view.tree_nodes = world.tree().nodes();
  view.history = &history;
  view.residuals = world.records().residuals();
  view.frozen = world.validation().frozen();
}

}  // namespace collidoscope
