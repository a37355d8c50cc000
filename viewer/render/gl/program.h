#pragma once
// A shader program from files in assets/shaders. Each stage is `frame.glsl` followed by one file, without
// includes. Owns the program.

#include <string>
#include <vector>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class Program {
 public:
  /// File names under assets/shaders. `definitions`: preprocessor lines at the start of both stages. Throws
  /// MachineError with the driver's messages and file names.
  Program(const std::string& vertex_file, const std::string& fragment_file,
          const std::string& definitions = "");
  /// Makes a compute program from one file.
  static Program compute(const std::string& file, const std::string& definitions = "");

  void use() const { glUseProgram(program_.get()); }
  /// Sets a uniform. Throws MachineError if the program does not use this name, which indicates a typing
  /// error.
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
