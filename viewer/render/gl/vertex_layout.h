#pragma once
// Which bytes of an instance record reach which input of a vertex shader. Owns a vertex array object; the
// buffer is bound at each draw, since growing gives it a new name.

#include <initializer_list>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class VertexLayout {
 public:
  struct Input {
    GLuint location;
    GLint count;              ///< components, 1 to 4
    GLuint offset;            ///< bytes from the start of the record
    bool integer = false;     ///< uint in the shader; else float
    bool per_vertex = false;  ///< from binding 1, one record a vertex; else from binding 0, one an instance
  };
  explicit VertexLayout(std::initializer_list<Input> inputs);

  void bind(GLuint instances, GLsizei instance_size, GLuint vertices = 0, GLsizei vertex_size = 0) const;

 private:
  VertexArrayHandle array_;
};

}  // namespace collidoscope::gl
