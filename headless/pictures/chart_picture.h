#pragma once
// A chart as a PNG, without a window. Owns an OpenGL context and ImGui's for as long as
// it lives: one at a time.

#include <string>

#include "headless/pictures/egl_context.h"
#include "ui/chart.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/window_frame.h"

namespace collidoscope {

class ChartPicture {
 public:
  /// Throws MachineError where the machine cannot draw.
  ChartPicture(int width = 1500, int height = 950);
  Image draw(const Chart& chart);

 private:
  EglContext context_;
  GuiPass gui_;
  WindowFrame frame_;
};

/// The colour of the k-th series on its ground.
std::uint32_t chart_color(std::size_t series);

}  // namespace collidoscope
