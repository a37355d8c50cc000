#include "viewer/render/gui_pass.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cmath>
#include <exception>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/error.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope {

GuiPass::GuiPass(float font_size) : font_size_(font_size) {
  IMGUI_CHECKVERSION();
  const std::string font = asset("fonts/JetBrainsMono-Regular.ttf")
                               .string();  // checked before the ImGui context is created, which would leak
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  load_fonts();
  if (!ImGui_ImplOpenGL3_Init("#version 450 core"))
    throw MachineError("Dear ImGui: no OpenGL library found; libGL.so.1 is required");
}

void GuiPass::load_fonts() {
  const std::string font = asset("fonts/JetBrainsMono-Regular.ttf").string();
  ImGuiIO& io = ImGui::GetIO();
  // Latin, Greek, dashes and dots, super- and subscripts, arrows, mathematical symbols.
  static constexpr ImWchar ranges[] = {0x0020, 0x00ff, 0x0370, 0x03ff, 0x2010, 0x2026, 0x2070,
                                       0x209f, 0x2190, 0x2193, 0x2200, 0x22ff, 0};
  ImFontConfig config;
  config.OversampleH = 2;
  config.OversampleV = 2;
  // The default font and the title font.
  if (!io.Fonts->AddFontFromFileTTF(font.c_str(), font_size_, &config, ranges) ||
      !io.Fonts->AddFontFromFileTTF(font.c_str(), std::round(1.6f * font_size_), &config, ranges))
    throw MachineError("font '" + font + "' cannot be loaded");
}

void GuiPass::set_font_size(float font_size) {
  if (font_size == font_size_) return;
  font_size_ = font_size;
  ImFontAtlas* const fonts = ImGui::GetIO().Fonts;
  std::exception_ptr failed;
  fonts->Clear();
  try {
    load_fonts();
  } catch (...) {  // fallback: a frame needs both fonts
    failed = std::current_exception();
    fonts->Clear();
    fonts->AddFontDefault();
    fonts->AddFontDefault();
  }
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
  if (failed) std::rethrow_exception(failed);
}

GuiPass::~GuiPass() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void GuiPass::begin(int width, int height, float step) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  io.DeltaTime = step;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
}

void GuiPass::end(const gl::Target& picture) {
  build();
  rasterise(picture);
}

void GuiPass::build() { ImGui::Render(); }

void GuiPass::rasterise(const gl::Target& picture) {
  picture.bind();
  glUseProgram(0);  // otherwise ImGui would restore a program that may have been deleted
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  gl::check("draw text and panels");
}

}  // namespace collidoscope
