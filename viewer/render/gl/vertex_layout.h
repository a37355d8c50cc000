#pragma once
// Mapping from instance records to the inputs of a vertex shader. Owns a vertex array object. The buffer is
// bound at each draw, since growing changes its name.

#include <initializer_list>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

class VertexLayout {
 public:
  struct Input {
    GLuint location;
    GLint count;              ///< number of components, 1 to 4
    GLuint offset;            ///< offset in the record, bytes
    bool integer = false;     ///< uint in the shader, else float
    bool per_vertex = false;  ///< binding 1, one record per vertex; else binding 0, one per instance
  };
  explicit VertexLayout(std::initializer_list<Input> inputs);

  void bind(GLuint instances, GLsizei instance_size, GLuint vertices = 0, GLsizei vertex_size = 0) const;

 private:
  VertexArrayHandle array_;
};

}  // namespace collidoscope::gl
