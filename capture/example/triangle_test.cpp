// Example of a picture test: a triangle, drawn with OpenGL without a window.
#include <GL/glcorearb.h>
#include <collidoscope/capture.h>
#include <collidoscope/offscreen.h>

#include <cstdlib>

namespace {

namespace capture = collidoscope::capture;

constexpr const char* vertex_shader = R"(#version 330
const vec2 corners[3] = vec2[](vec2(-0.7, -0.6), vec2(0.8, -0.5), vec2(0, 0.8));
const vec3 colors[3] = vec3[](vec3(0.9, 0.3, 0.2), vec3(0.2, 0.8, 0.4), vec3(0.3, 0.4, 0.9));
out vec3 color;
void main() { gl_Position = vec4(corners[gl_VertexID], 0, 1); color = colors[gl_VertexID]; })";
constexpr const char* fragment_shader = R"(#version 330
in vec3 color;
out vec4 pixel;
void main() { pixel = vec4(color, 1); })";

TEST(Triangle, LooksLikeItsGolden) {
  const capture::OffscreenContext context(320, 200);
  capture::settings().goldens = GOLDEN_FOLDER;
  capture::settings().renderer = context.renderer();
#define GL(type, name) const auto name = reinterpret_cast<type>(context.function(#name))
  GL(PFNGLCREATESHADERPROC, glCreateShader);
  GL(PFNGLSHADERSOURCEPROC, glShaderSource);
  GL(PFNGLCOMPILESHADERPROC, glCompileShader);
  GL(PFNGLCREATEPROGRAMPROC, glCreateProgram);
  GL(PFNGLATTACHSHADERPROC, glAttachShader);
  GL(PFNGLLINKPROGRAMPROC, glLinkProgram);
  GL(PFNGLUSEPROGRAMPROC, glUseProgram);
  GL(PFNGLGENVERTEXARRAYSPROC, glGenVertexArrays);
  GL(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray);
  GL(PFNGLCLEARCOLORPROC, glClearColor);
  GL(PFNGLCLEARPROC, glClear);
  GL(PFNGLVIEWPORTPROC, glViewport);
  GL(PFNGLDRAWARRAYSPROC, glDrawArrays);

  const GLuint program = glCreateProgram();
  for (const auto& [kind, source] : {std::pair<GLenum, const char*>(GL_VERTEX_SHADER, vertex_shader),
                                     std::pair<GLenum, const char*>(GL_FRAGMENT_SHADER, fragment_shader)}) {
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  glUseProgram(program);
  GLuint vertices = 0;
  glGenVertexArrays(1, &vertices);
  glBindVertexArray(vertices);
  // A planted error, to see a failure: TRIANGLE_SHIFT=1.
  if (const char* shift = std::getenv("TRIANGLE_SHIFT")) glViewport(std::atoi(shift), 0, 320, 200);
  glClearColor(0.09f, 0.1f, 0.12f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  glDrawArrays(GL_TRIANGLES, 0, 3);

  const capture::Picture picture = context.read();
  capture::Tolerance tolerance = capture::tight();
  tolerance.must_detect = 12;  // pixels
  EXPECT_LOOKS_LIKE("triangle", picture.pixels(), tolerance);
}

}  // namespace
