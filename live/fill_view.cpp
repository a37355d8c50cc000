#include "live/fill_view.h"

namespace collidoscope {

void fill_view(LiveWorld& live, WorkspaceView& view) {
  World& world = live.world();
  view.scene = world.scene().name;
  view.generated = live.generated();
  view.in_effect = live.settings();
  view.edited = live.edited();
  view.executor = world.on_gpu() ? "CUDA" : "CPU";
  view.device = world.device_name();
  view.broad_phases = broad_phase_names();
  view.effects.clear();
  for (const EffectName& effect : effect_names)
    if (world.effects().*(effect.flag)) view.effects.emplace_back(effect.name);
  view.stats = live.stats();
  view.time = static_cast<double>(world.steps()) * world.scene().physics.time_step;
  view.allocated_bytes = world.allocated_bytes();
  view.level_sizes = live.level_sizes();
  view.history = &live.history();
}

}  // namespace collidoscope
