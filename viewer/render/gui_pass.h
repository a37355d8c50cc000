#pragma once
// Dear ImGui, drawn into a framebuffer of ours. Owns the ImGui context and its font; one at a time, with the
// GL context that was current when it was made. Keeps no file and reads no clock.

#include "viewer/render/gl/target.h"

namespace collidoscope {

class GuiPass {
 public:
  /// `font_size`: pixels, of the font under assets/fonts; a second one, 1.6 times as large, is for titles.
  explicit GuiPass(float font_size);
  ~GuiPass();
  GuiPass(const GuiPass&) = delete;
  GuiPass& operator=(const GuiPass&) = delete;

  /// Between frames. Throws MachineError where the font cannot be read; text then is in ImGui's own font.
  void set_font_size(float font_size);

  /// Between the two, ImGui may be called. `step`: s, told to ImGui as the time since the last frame.
  void begin(int width, int height, float step = 1.0f / 60);
  void end(const gl::Target& picture);
  /// The two halves of end(), for those who time them: the CPU lists triangles, and OpenGL draws them.
  void build();
  void rasterise(const gl::Target& picture);

 private:
  void load_fonts();

  float font_size_;
};

}  // namespace collidoscope
