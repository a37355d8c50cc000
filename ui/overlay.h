#pragma once
// The text on a picture: what is simulated, how, what was found and what it cost; and the legend. A free
// function over a plain struct that the caller fills.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/core/stage_times.h"
#include "ui/legend_text.h"

namespace collidoscope {

/// sRGB, 0xAABBGGRR as ImGui has it.
using PackedColor = std::uint32_t;

struct OverlayText {
  std::string scene;
  std::int64_t state = 0;
  double time = 0;  ///< s of simulated time
  std::int64_t bodies = 0;
  LaunchShape shape;     ///< zeros are drawn as "auto"
  std::string variant;   ///< empty: not drawn
  std::string executor;  ///< "CPU" or "CUDA"
  std::string device;    ///< its name
  std::int64_t pairs = 0, touching = 0, speculative = 0;
  std::vector<StageTime> stages;
  double step_ms = 0;    ///< median of whole steps
  bool timings = false;  ///< false: times are drawn as a dash, so that pictures repeat

  Legend body_colors, box_colors;  ///< colour bars
  struct Level {
    int level;
    PackedColor color;
  };
  std::vector<Level> levels;  ///< of the hierarchy, those drawn, where they are coloured so
  std::int64_t boxes_drawn = 0;
  bool contacts_shown = false;
  std::vector<PackedColor> contact_colors;  ///< from weak to strong
  double max_impulse = 0;                   ///< N s, of the last of them; 0: none are known
  struct Key {
    std::string name;
    PackedColor color;
  };
  std::vector<Key> keys;    ///< what else is drawn
  double grid_spacing = 0;  ///< m; 0: no grid
};

/// Draws in front of everything, between ImGui::NewFrame() and Render(). Leaves out what does not fit.
void draw_overlay(const OverlayText& text, float width, float height);

/// The size in pixels that the overlay's text wants on a picture of this size.
float overlay_font_size(int width, int height);

}  // namespace collidoscope
