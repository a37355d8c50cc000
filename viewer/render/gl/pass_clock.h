#pragma once
// What each pass of a frame costs on the GPU, by timestamps between them. One frame at a time; belongs to
// whoever measures, and needs the GL context that was current when it was made.

#include <string>
#include <utility>
#include <vector>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

inline void delete_query(GLuint name) { glDeleteQueries(1, &name); }
using QueryHandle = Handle<delete_query>;

class PassClock {
 public:
  /// Before the first pass of a frame.
  void begin();
  /// After a pass; `pass` outlives the clock.
  void mark(const char* pass);
  /// ms of each pass since begin(), in their order. Waits for the GPU.
  std::vector<std::pair<const char*, double>> read();

 private:
  void stamp();

  std::vector<QueryHandle> queries_;  // one more than names_, kept from frame to frame
  std::vector<const char*> names_;
};

}  // namespace collidoscope::gl
