#pragma once
// Draws records over surfaces with known depth: hidden parts first and faint, then visible parts. Each record
// expands to a fixed number of vertices. The shader fetches records from the storage buffer at binding 0.
// Blends; does not write depth. Free functions; all state that they set belongs to the pass.

#include <cstdint>

#include "viewer/render/gl/buffer.h"
#include "viewer/render/gl/program.h"
#include "viewer/render/gl/vertex_layout.h"

namespace collidoscope {

/// A range of records in a buffer.
struct Records {
  const gl::Buffer& buffer;
  std::int64_t bytes, first, count;  ///< bytes: size of a record

  /// Calls draw(first, count) for blocks of records, with `first` relative to the bound range. Blocks are
  /// needed since shaders can access a limited part of a buffer, and vertex counts have 32 bits. The last
  /// block comes first, since boxes are drawn backwards.
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

/// A lower opacity does not change a colour of 8 bits.
inline constexpr float min_visible_opacity = 0.5f / 255;

/// Binds the program and sets the state for see-through records.
void begin_see_through(const gl::Program& program, const gl::VertexLayout& nothing);

/// Sets the uniforms `first` (first record), `strength` (opacity of the pass), and `count` (records in the
/// block, if drawn backwards). `shown` and `hidden` are opacities.
void draw_see_through(const gl::Program& program, const gl::VertexLayout& nothing, GLenum mode,
                      GLsizei vertices, const Records& records, float shown, float hidden,
                      bool backwards = false);

}  // namespace collidoscope
