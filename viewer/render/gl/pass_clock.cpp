#include "viewer/render/gl/pass_clock.h"

#include "viewer/render/gl/errors.h"

namespace collidoscope::gl {

void PassClock::stamp() {
  if (queries_.size() <= names_.size()) {
    GLuint query = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &query);
    queries_.emplace_back(query);
  }
  glQueryCounter(queries_[names_.size()].get(), GL_TIMESTAMP);
}

void PassClock::begin() {
  names_.clear();
  stamp();
}

void PassClock::mark(const char* pass) {
  names_.push_back(pass);
  stamp();
}

std::vector<std::pair<const char*, double>> PassClock::read() {
  std::vector<std::pair<const char*, double>> times;
  if (queries_.empty()) return times;
  const auto at = [&](std::size_t i) {
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(queries_[i].get(), GL_QUERY_RESULT, &nanoseconds);
    return nanoseconds;
  };
  GLuint64 before = at(0);
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const GLuint64 now = at(i + 1);
    times.emplace_back(names_[i], now > before ? static_cast<double>(now - before) * 1e-6 : 0.0);
    before = now;
  }
  check("read the times of the passes of a frame");
  return times;
}

}  // namespace collidoscope::gl
