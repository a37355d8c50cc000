#pragma once
// A shader program made of files from assets/shaders. Each stage is the shared `frame.glsl` followed by one
// file; there is no include mechanism. Owns the program.

#include <string>
#include <vector>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class Program {
 public:
  /// File names under assets/shaders. `definitions`: lines of the preprocessor that both stages start with.
  /// Throws MachineError with the driver's words, files by name.
  Program(const std::string& vertex_file, const std::string& fragment_file,
          const std::string& definitions = "");
  /// The same of one file, a compute shader.
  static Program compute(const std::string& file, const std::string& definitions = "");

  void use() const { glUseProgram(program_.get()); }
  /// Uniforms by name; one that the program does not use is a MachineError, since it is a slip of the pen.
  void set(const char* name, float value) const;
  void set(const char* name, int value) const;
  void set(const char* name, float x, float y, float z, float w) const;

 private:
  struct Stage {
    GLenum kind;
    std::string file;
  };
  Program(const std::vector<Stage>& stages, const std::string& definitions);
  GLint location(const char* name) const;

  std::string name_;
  ProgramHandle program_;
};

}  // namespace collidoscope::gl
