#include "viewer/render/gl/vertex_layout.h"

#include "viewer/render/gl/errors.h"

namespace collidoscope::gl {

VertexLayout::VertexLayout(std::initializer_list<Input> inputs) {
  GLuint array = 0;
  glCreateVertexArrays(1, &array);
  array_ = VertexArrayHandle(array);
  for (const Input& input : inputs) {
    glEnableVertexArrayAttrib(array, input.location);
    if (input.integer)
      glVertexArrayAttribIFormat(array, input.location, input.count, GL_UNSIGNED_INT, input.offset);
    else
      glVertexArrayAttribFormat(array, input.location, input.count, GL_FLOAT, GL_FALSE, input.offset);
    glVertexArrayAttribBinding(array, input.location, input.per_vertex ? 1 : 0);
  }
  glVertexArrayBindingDivisor(array, 0, 1);
  check("create a vertex layout");
}

void VertexLayout::bind(GLuint instances, GLsizei instance_size, GLuint vertices, GLsizei vertex_size) const {
  if (instances) glVertexArrayVertexBuffer(array_.get(), 0, instances, 0, instance_size);
  if (vertices) glVertexArrayVertexBuffer(array_.get(), 1, vertices, 0, vertex_size);
  glBindVertexArray(array_.get());
}

}  // namespace collidoscope::gl
