#pragma once
// Draws records over surfaces whose depth is known: first, faintly, what they hide, then what lies before
// them. Each record makes so many vertices, which a shader fetches by itself, from the storage buffer at
// binding 0. Blends, and leaves depth as it is. Free functions; all state that they set is the pass's own.

#include <cstdint>

#include "viewer/render/gl/buffer.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"

namespace collidoscope {

/// Of a buffer, those to draw.
struct Records {
  const gl::Buffer& buffer;
  std::int64_t bytes, first, count;  ///< of one; to draw

  /// Gives blocks of them to draw(first, count), bound so that `first` counts from the start of what is
  /// bound: shaders reach a limited part of a buffer at once, and vertices are counted in 32 bits. The last
  /// block first, since boxes are drawn backwards.
  template <class Draw>
  void in_blocks(const Draw& draw) const {
    constexpr std::int64_t block = 1 << 20;
    for (std::int64_t end = first + count; end > first;) {
      const std::int64_t start = (end - 1) / block * block, from = start > first ? start : first;
      glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 0, buffer.get(), start * bytes, (end - start) * bytes);
      draw(static_cast<int>(from - start), static_cast<int>(end - from));
      end = from;
    }
  }
};

/// Less of an opacity changes no colour of 8 bits.
inline constexpr float min_visible_opacity = 0.5f / 255;

/// Makes the program and the state that see-through records are drawn with current.
void begin_see_through(const gl::Program& program, const gl::VertexLayout& nothing);

/// The shader's uniforms: `first`, the record to begin with; `strength`, the opacity of the pass; and, where
/// it draws backwards, `count`, the records of the block. `shown` and `hidden` are opacities.
void draw_see_through(const gl::Program& program, const gl::VertexLayout& nothing, GLenum mode,
                      GLsizei vertices, const Records& records, float shown, float hidden,
                      bool backwards = false);

}  // namespace collidoscope
