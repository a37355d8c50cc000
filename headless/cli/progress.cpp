#include "headless/cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "sim_cuda/run/step_estimate.h"
#include "sim_cuda/snapshot/settle.h"

namespace collidoscope {
namespace {

std::string time_left(double seconds) {
  constexpr double longest = 359'999;  // 99:59:59
  const auto whole = static_cast<std::int64_t>(std::min(seconds, longest));
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

int columns_of(std::FILE* stream) {
  winsize size{};
  return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string progress_line(std::string_view what, std::int64_t done, std::int64_t total, double seconds,
                          int width) {
  constexpr int longest_bar = 40, shortest_bar = 5;
  const double share =
      total > 0 ? std::clamp(static_cast<double>(done) / static_cast<double>(total), 0.0, 1.0) : 1;
  std::string tail = fmt::format(" {:3.0f} %  {}/{}", 100 * share, done, total);
  if (done > 0 && seconds > 0) {
    const double rate = static_cast<double>(done) / seconds;
    tail += fmt::format("  {:.1f}/s", rate);
    if (done < total) tail += fmt::format("  {} left", time_left(static_cast<double>(total - done) / rate));
  }
  const int room = width - static_cast<int>(what.size() + tail.size()) - 3;
  std::string line(what);
  if (room >= shortest_bar) {
    const int bar = std::min(room, longest_bar);
    const auto full = static_cast<std::size_t>(share * bar);
    line += " [" + std::string(full, '#') + std::string(static_cast<std::size_t>(bar) - full, '-') + "]";
  }
  line += tail;
  return line.substr(0, static_cast<std::size_t>(std::max(width, 0)));
}

void announce_long_work() {
  const auto bar = std::make_shared<std::optional<Progress>>();
  const auto progress = [bar](std::int64_t steps, std::int64_t most) {
    if (!*bar) bar->emplace("settle", most);
    (*bar)->update(steps);
    if (steps == most) bar->reset();
  };
  const auto log = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  set_settle_news({progress, log});
  set_slow_step_callback([log, last = std::string()](const std::string& line) mutable {
    if (line != last) log(line);  // worlds of one scene are often made one after the other
    last = line;
  });
}

Progress::Progress(std::string what, std::int64_t total, std::FILE* stream)
    : what_(std::move(what)), total_(total), stream_(stream), visible_(isatty(fileno(stream)) == 1) {}

Progress::~Progress() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stream_);  // to the line's start; erase to its end
  std::fflush(stream_);
}

void Progress::update(std::int64_t done) {
  const Clock::time_point now = Clock::now();
  if (!visible_ || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  // One column stays free: some terminals wrap as soon as the last is written.
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const std::string line = progress_line(what_, done, total_, seconds, columns_of(stream_) - 1);
  std::fputs(("\r" + line + "\x1b[K").c_str(), stream_);
  std::fflush(stream_);
  drawn_ = true;
}

}  // namespace collidoscope
