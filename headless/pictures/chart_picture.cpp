#include "headless/pictures/chart_picture.h"

#include "ui/widgets.h"

namespace collidoscope {

namespace {
constexpr float font_size = 22;
}

ChartPicture::ChartPicture(int width, int height) : gui_(font_size), frame_(width, height) {}

Image ChartPicture::draw(const Chart& chart) {
  // ImGui needs several frames to lay out a new window.
  for (int round = 0; round < 3; ++round) {
    gui_.begin(frame_.width(), frame_.height());
    draw_chart_page(static_cast<float>(frame_.width()), static_cast<float>(frame_.height()), font_size,
                    chart);
    gui_.end(frame_.target());
  }
  return frame_.read();
}

std::uint32_t chart_color(std::size_t series) { return stage_color(series, true); }

}  // namespace collidoscope
