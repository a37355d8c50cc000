#pragma once
// A progress bar on a terminal; nothing where the stream is none (a file, a pipe, CI). Redrawn at most ten
// times a second, wiped at the end. Lives as long as the work it shows.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace collidoscope {

/// `steps [#####-----]  50 %  150/300  120.3/s  0:01 left`, shortened from the right where `width` columns
/// cannot hold it. `seconds`: since the start. ASCII.
std::string progress_line(std::string_view what, std::int64_t done, std::int64_t total, double seconds,
                          int width);

/// For the rest of the program: a bar for worlds that settle (sim_cuda/snapshot/presimulation.h), and lines
/// on stderr about them and about steps that will take long (sim_cuda/run/step_estimate.h).
void announce_long_work();

class Progress {
 public:
  Progress(std::string what, std::int64_t total, std::FILE* stream = stderr);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::int64_t done);
  bool visible() const { return visible_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  std::int64_t total_;
  std::FILE* stream_;
  bool visible_, drawn_ = false;
  Clock::time_point start_ = Clock::now(), last_{};
};

}  // namespace collidoscope
