#include "headless/pictures/chart_picture.h"

#include "ui/widgets.h"

namespace collidoscope {

namespace {
constexpr float font_size = 22;
}

ChartPicture::ChartPicture(int width, int height) : gui_(font_size), frame_(width, height) {}

template <class Page>
Image ChartPicture::draw_page(const Page& page) {
  // ImGui needs several frames to lay out a new window.
  for (int round = 0; round < 3; ++round) {
    gui_.begin(frame_.width(), frame_.height());
    page(static_cast<float>(frame_.width()), static_cast<float>(frame_.height()));
    gui_.end(frame_.target());
  }
  return frame_.read();
}

Image ChartPicture::draw(const Chart& chart) {
  return draw_page([&](float width, float height) { draw_chart_page(width, height, font_size, chart); });
}

Image ChartPicture::draw(const HeatMap& map) {
  return draw_page([&](float width, float height) { draw_heat_map_page(width, height, font_size, map); });
}

std::uint32_t chart_color(std::size_t series) { return stage_color(series, true); }

}  // namespace collidoscope
