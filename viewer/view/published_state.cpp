#include "viewer/view/published_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "viewer/render/legend.h"
#include "viewer/render/value_range.h"
#include "viewer/session/fill_view.h"

namespace collidoscope {
namespace {

void publish_scene(LiveWorld& live, PublishedState& to) {
  if (to.scene && to.scene->generation == live.generation()) return;
  World& world = live.world();
  to.scene = std::make_shared<const PublishedState::SceneData>(PublishedState::SceneData{
      live.generation(), frame_scene(world.scene(), world.initial()), world.scene().camera, world.info()});
}

void publish_records(LiveWorld& live, const PublishRequest& request, LiveReference* reference,
                     PublishedState& to) {
  PublishedState::Key wanted{live.generation(), live.world().steps(), request.layers,
                             reference ? reference->version() : 0};
  if (wanted == to.key) return;
  const FrameLayers& layers = request.layers;
  if (reference != nullptr && layers.needs_reference()) {
    to.ghosts = reference->ghosts(live.world(), live.generation());
    wanted.reference = reference->version();
  }
  const StepStats& stats = live.stats();  // measures the state, so that boxes and contacts match the bodies
  live.world().publisher().copy(layers, to.records);
  to.range = value_range(live.world(), to.scene->frame, layers, stats);
  to.view.body_colors = layers.spheres ? body_legend(layers.color, to.range, stats) : Legend{};
  to.view.box_colors = layers.boxes ? box_legend(layers.box_color, to.range) : Legend{};
  to.key = wanted;
}

void publish_selection(LiveWorld& live, const PublishRequest& request, PublishedState& to) {
  if (!request.selection || *request.selection >= live.world().initial().size()) {
    to.selected.reset();
    return;
  }
  const bool known = to.selected && to.selected->id == *request.selection &&
                     to.selected_generation == live.generation() && to.selected_step == live.world().steps();
  if (known) return;
  live.stats();  // measures the state, which computes its contacts and boxes
  to.selected = live.world().inspect(*request.selection);
  to.selected_generation = live.generation();
  to.selected_step = live.world().steps();
}

void publish_frozen(LiveWorld& live, PublishedState& to) {
  constexpr std::size_t most = 100;
  const std::vector<std::uint32_t>& ids = live.world().validation().frozen();
  const std::size_t shown = std::min(ids.size(), most);
  if (to.frozen_generation == live.generation() &&
      std::ranges::equal(to.frozen, std::span(ids).first(shown), {}, &PublishedState::Frozen::id))
    return;
  to.frozen_generation = live.generation();
  to.frozen.clear();
  if (shown == 0) return;
  const BodyStates bodies = live.world().bodies();
  for (const std::uint32_t id : std::span(ids).first(shown))
    to.frozen.push_back({id, bodies.position[id], live.world().initial().radius[id]});
}

/// Missing and duplicate pairs of the last run of a plug-in.
void publish_faulty_pairs(LiveWorld& live, PublishedState& to) {
  to.faulty_pairs.clear();
  if (!to.view.has_wrong_pairs) return;
  const std::optional<PairCheck> check = live.world().pair_check();
  if (!check || !check->examples_are_of_last_run) return;
  const BodyStates bodies = live.world().bodies();
  const std::vector<double>& radius = live.world().initial().radius;
  for (const FaultyPair& pair : check->examples)
    if (pair.fault == PairFault::missing || pair.fault == PairFault::duplicate)
      to.faulty_pairs.push_back({bodies.position[pair.a], bodies.position[pair.b], radius[pair.a],
                                 radius[pair.b],
                                 fmt::format("{} {}-{}", name_of(pair.fault), pair.a, pair.b)});
}

}  // namespace

void publish_state(LiveWorld& live, const PublishRequest& request, LiveReference* reference,
                   PublishedState& to) {
  publish_scene(live, to);
  publish_records(live, request, reference, to);
  publish_selection(live, request, to);
  publish_frozen(live, to);
  to.history = live.history();
  fill_view(live.world(), live.stats(), to.history, to.view);
  publish_faulty_pairs(live, to);
  to.view.history = nullptr;
  to.view.stop.reset();
  to.view.level_sizes = live.level_sizes(request.layers.boxes || request.exact_levels);
  to.view.edited = live.edited();
  to.view.changes = std::ssize(live.changes());
  to.view.timeline = {live.timeline().first(), live.timeline().last(), live.marks(), live.lanes(),
                      live.other_run()};
  to.view.boxes_drawn = to.range.boxes;
  to.view.max_impulse = to.range.max_impulse;
  to.view.error_scale = to.range.error_scale;
}

}  // namespace collidoscope
