#pragma once
// All that the window shows of one state of a run, as copies. The run can continue while it is drawn.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/run/published_records.h"
#include "ui/workspace.h"
#include "viewer/render/frame_scene.h"
#include "viewer/render/frame_uniforms.h"
#include "viewer/session/live_reference.h"
#include "viewer/session/live_world.h"

namespace collidoscope {

/// What is shown of each state.
struct PublishRequest {
  FrameLayers layers;
  std::optional<std::uint32_t> selection;    ///< id of a body
  bool impulses = false, residuals = false;  ///< record them in each step
  bool exact_levels = true;                  ///< see LiveWorld::level_sizes()

  friend bool operator==(const PublishRequest&, const PublishRequest&) = default;
};

struct PublishedState {
  /// The state, and what was copied of it.
  struct Key {
    int generation = -1;  ///< LiveWorld::generation()
    std::int64_t step = -1;
    FrameLayers layers;
    int reference = 0;  ///< LiveReference::version()
    friend bool operator==(const Key&, const Key&) = default;
  } key;
  PublishedRecords records;
  std::vector<GhostInstance> ghosts;
  ValueRange range;

  /// Data of the scene, shared by all states of a generation.
  struct SceneData {
    int generation;
    FrameScene frame;
    Camera camera;
    WorldInfo info;
  };
  std::shared_ptr<const SceneData> scene;

  std::optional<BodyReport> selected;
  int selected_generation = -1;
  std::int64_t selected_step = -1;

  struct Frozen {
    std::uint32_t id;
    Vector3d at;    ///< m
    double radius;  ///< m
  };
  std::vector<Frozen> frozen;  ///< the first hundred; positions are constant
  int frozen_generation = -1;

  struct FaultyPairBodies {
    Vector3d a, b;              ///< m
    double radius_a, radius_b;  ///< m
    std::string text;
  };
  std::vector<FaultyPairBodies> faulty_pairs;  ///< of a plug-in, at this state

  WorkspaceView view;  ///< values from the run; `history` and `stop` are not set
  History history;
};

/// Copies the present state to `to`. Parts that `to` already has are kept. `reference`: needed if the layers
/// need it.
void publish_state(LiveWorld& live, const PublishRequest& request, LiveReference* reference,
                   PublishedState& to);

}  // namespace collidoscope
