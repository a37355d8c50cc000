#pragma once
// The text on a picture: scene, settings, counts, times and legend. A free function over a plain struct that
// the caller fills.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/core/stage_times.h"
#include "ui/legend_text.h"

namespace collidoscope {

/// sRGB, 0xAABBGGRR as in ImGui.
using PackedColor = std::uint32_t;

struct OverlayText {
  std::string scene;
  std::int64_t state = 0;
  double time = 0;  ///< s, simulated time
  std::int64_t bodies = 0;
  LaunchShape shape;     ///< 0 is drawn as "auto"
  std::string variant;   ///< empty: not drawn
  std::string executor;  ///< "CPU" or "CUDA"
  std::string device;    ///< name of the device
  std::int64_t pairs = 0, touching = 0, speculative = 0;
  std::string pairs_note;  ///< of a broad phase that is a plug-in; see WorkspaceView::pairs_note
  std::vector<StageTime> stages;
  double step_ms = 0;    ///< median time of whole steps
  bool timings = false;  ///< false: times are drawn as a dash, for reproducible pictures

  Legend body_colors, box_colors;  ///< colour bars
  struct Level {
    int level;
    PackedColor color;
  };
  std::vector<Level> levels;  ///< drawn levels of the tree, if coloured by level
  std::int64_t boxes_drawn = 0;
  bool contacts_shown = false;
  std::vector<PackedColor> contact_colors;  ///< ascending impulse
  double max_impulse = 0;                   ///< N s, of the last contact colour; 0: not recorded
  struct Key {
    std::string name;
    PackedColor color;
  };
  std::vector<Key> keys;    ///< other legend entries
  double grid_spacing = 0;  ///< m; 0: no grid
};

/// Draws in front of everything, between ImGui::NewFrame() and Render(). Rows that do not fit are left out.
void draw_overlay(const OverlayText& text, float width, float height);

/// Font size of the overlay in pixels for a picture of this size.
float overlay_font_size(int width, int height);

}  // namespace collidoscope
