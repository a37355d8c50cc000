#pragma once
// Draws Dear ImGui into an own framebuffer. Owns the ImGui context and its fonts; only one instance at a
// time. Requires the GL context of its construction. Writes no files and reads no clock.

#include "viewer/render/gl/target.h"

namespace collidoscope {

class GuiPass {
 public:
  /// `font_size`: pixels, of the font under assets/fonts. The title font is 1.6 times as large.
  explicit GuiPass(float font_size);
  ~GuiPass();
  GuiPass(const GuiPass&) = delete;
  GuiPass& operator=(const GuiPass&) = delete;

  /// Call between frames. Throws MachineError if the font cannot be read; ImGui's own font is used then.
  void set_font_size(float font_size);

  /// Starts a frame; ImGui may be called until end(). `step`: s, time since the last frame for ImGui.
  void begin(int width, int height, float step = 1.0f / 60);
  void end(const gl::Target& picture);
  /// The two halves of end(), for timing: triangle lists on the CPU, and drawing with OpenGL.
  void build();
  void rasterise(const gl::Target& picture);

 private:
  void load_fonts();

  float font_size_;
};

}  // namespace collidoscope
