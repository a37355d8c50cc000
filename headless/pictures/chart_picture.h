#pragma once
// Draws charts and heat maps to images without a window. Owns an OpenGL context and an ImGui context; only
// one object may exist at a time.

#include <string>

#include "headless/pictures/egl_context.h"
#include "ui/chart.h"
#include "ui/heat_map.h"
#include "viewer/render/gui_pass.h"
#include "viewer/render/window_frame.h"

namespace collidoscope {

class ChartPicture {
 public:
  /// Sizes in pixels. Throws MachineError if the machine cannot draw.
  ChartPicture(int width = 1500, int height = 950);
  Image draw(const Chart& chart);
  Image draw(const HeatMap& map);

 private:
  /// `page(width, height)` draws ImGui windows.
  template <class Page>
  Image draw_page(const Page& page);

  EglContext context_;
  GuiPass gui_;
  WindowFrame frame_;
};

/// Colour of the k-th series.
std::uint32_t chart_color(std::size_t series);

}  // namespace collidoscope
