#pragma once
// GPU time of each pass of a frame, by timestamp queries. One frame at a time. Requires the GL context of its
// construction.

#include <string>
#include <utility>
#include <vector>

#include "viewer/render/gl/handle.h"

namespace collidoscope::gl {

inline void delete_query(GLuint name) { glDeleteQueries(1, &name); }
using QueryHandle = Handle<delete_query>;

class PassClock {
 public:
  /// Call before the first pass of a frame.
  void begin();
  /// Call after a pass; `pass` must outlive the clock.
  void mark(const char* pass);
  /// ms of each pass since begin(), in order. Waits for the GPU.
  std::vector<std::pair<const char*, double>> read();

 private:
  void stamp();

  std::vector<QueryHandle> queries_;  // one more than names_, reused in later frames
  std::vector<const char*> names_;
};

}  // namespace collidoscope::gl
