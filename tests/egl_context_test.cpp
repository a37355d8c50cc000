// Tests the EGL context and the OpenGL wrappers: choice of the device, error messages that name the call, and
// buffers that grow.
#include "headless/pictures/egl_context.h"

#include <epoxy/gl.h>
#include <gmock/gmock.h>

#include "sim_cuda/core/error.h"
#include "tests/gl_fixture.h"
#include "viewer/render/gl/buffer.h"
#include "viewer/render/gl/errors.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/target.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const MachineError& error) {
    return error.what();
  }
  return "";
}

TEST(EglContext, SaysWhatDraws) {
  const EglContext& context = test_context();
  EXPECT_FALSE(context.renderer().empty());
  EXPECT_EQ(context.version().substr(0, 1), "4");
  EXPECT_EQ(context.software(), gl::is_software_renderer());
}

TEST(EglContext, ADeviceThatIsNotThereIsAStepDownWithALine) {
  const EglContext context(4096);
  EXPECT_THAT(context.steps_down(), testing::Contains(HasSubstr("is CUDA device 4096")));
  EXPECT_NE(context.cuda_device(), 4096);
}

TEST(Gl, AWrongCallIsReportedWithWhatWasBeingDone) {
  test_context();
  gl::check("nothing");
  glEnable(GL_TEXTURE_2D + 1);
  EXPECT_THAT(refusal([] { gl::check("run an invalid call"); }),
              HasSubstr("OpenGL: cannot run an invalid call: "));
  EXPECT_EQ(refusal([] { gl::check("nothing"); }), "");
}

TEST(Gl, ImpossibleRequestsNameTheirSize) {
  test_context();
  EXPECT_THAT(refusal([] { gl::make_texture("huge", 1 << 24, 16, GL_RGBA8); }),
              HasSubstr("16777216x16 for 'huge'"));
  gl::Buffer buffer("small");
  buffer.reserve(64);
  char bytes[128];
  EXPECT_THAT(refusal([&] { buffer.read(bytes, sizeof bytes); }),
              HasSubstr("'small' holds 64 bytes, not 128"));
}

TEST(Gl, ABufferGrowsAndKeepsWhatFits) {
  test_context();
  gl::Buffer buffer("growing");
  const int first[4] = {1, 2, 3, 4};
  buffer.upload(first, sizeof first);
  EXPECT_EQ(buffer.generation(), 1);
  buffer.upload(first, 8);
  EXPECT_EQ(buffer.generation(), 1);
  const std::vector<int> more(1000, 7);
  buffer.upload(more.data(), more.size() * sizeof(int));
  EXPECT_EQ(buffer.generation(), 2);
  std::vector<int> back(1000);
  buffer.read(back.data(), back.size() * sizeof(int));
  EXPECT_EQ(back, more);
}

TEST(Gl, AShaderThatDoesNotCompileIsNamed) {
  test_context();
  EXPECT_THAT(refusal([] { gl::Program("sphere.vert", "sphere.frag", "this is no GLSL\n"); }),
              HasSubstr("shader 'sphere.vert'"));
  EXPECT_THAT(refusal([] { gl::Program("missing.vert", "sphere.frag"); }), HasSubstr("shaders/missing.vert"));
  const gl::Program program("fullscreen.vert", "sphere_merge.frag", "#define SHADOW\n");
  EXPECT_THAT(refusal([&] { program.set("speling", 1); }), HasSubstr("no uniform 'speling'"));
}

}  // namespace
}  // namespace collidoscope
