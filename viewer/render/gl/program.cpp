#include "viewer/render/gl/program.h"

#include <fstream>
#include <sstream>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/error.h"
#include "viewer/render/gl/errors.h"

namespace collidoscope::gl {
namespace {

std::string read_text(const std::string& name) {
  const std::string path = asset("shaders/" + name).string();
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw MachineError("shader '" + path + "' cannot be read");
  return text.str();
}

ShaderHandle compile(GLenum stage, const std::string& file, const std::string& definitions) {
  // #line directives give file number and line in the driver's messages.
  const std::string kind = stage == GL_VERTEX_SHADER ? "#define VERTEX_STAGE\n" : "";
  const std::string source = "#version 450 core\n" + kind + definitions + "#line 1 0\n" +
                             read_text("frame.glsl") + "#line 1 1\n" + read_text(file);
  ShaderHandle shader(glCreateShader(stage));
  const char* text = source.c_str();
  glShaderSource(shader.get(), 1, &text, nullptr);
  glCompileShader(shader.get());
  GLint ok = 0;
  glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &ok);
  if (!ok) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader.get(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    forget_errors();
    throw MachineError("shader '" + file + "' (1; 0 is frame.glsl) does not compile: " + log);
  }
  return shader;
}

}  // namespace

Program::Program(const std::string& vertex_file, const std::string& fragment_file,
                 const std::string& definitions)
    : Program({{GL_VERTEX_SHADER, vertex_file}, {GL_FRAGMENT_SHADER, fragment_file}}, definitions) {}

Program Program::compute(const std::string& file, const std::string& definitions) {
  return Program({{GL_COMPUTE_SHADER, file}}, definitions);
}

Program::Program(const std::vector<Stage>& stages, const std::string& definitions) {
  std::vector<ShaderHandle> shaders;
  for (const Stage& stage : stages) {
    name_ += (name_.empty() ? "" : " + ") + stage.file;
    shaders.push_back(compile(stage.kind, stage.file, definitions));
  }
  program_ = ProgramHandle(glCreateProgram());
  for (const ShaderHandle& shader : shaders) glAttachShader(program_.get(), shader.get());
  glLinkProgram(program_.get());
  GLint ok = 0;
  glGetProgramiv(program_.get(), GL_LINK_STATUS, &ok);
  if (!ok) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program_.get(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    forget_errors();
    throw MachineError("shaders " + name_ + " do not link: " + log);
  }
  for (const ShaderHandle& shader : shaders) glDetachShader(program_.get(), shader.get());
  check("create the program " + name_);
}

GLint Program::location(const char* name) const {
  const GLint at = glGetUniformLocation(program_.get(), name);
  if (at < 0) throw MachineError("shaders " + name_ + " have no uniform '" + name + "'");
  return at;
}

void Program::set(const char* name, float value) const {
  glProgramUniform1f(program_.get(), location(name), value);
}
void Program::set(const char* name, int value) const {
  glProgramUniform1i(program_.get(), location(name), value);
}
void Program::set(const char* name, float x, float y, float z, float w) const {
  glProgramUniform4f(program_.get(), location(name), x, y, z, w);
}

}  // namespace collidoscope::gl
