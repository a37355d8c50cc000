// Tests the progress line: content, width of the terminal, a clean line at the end, and no output to a pipe.
#include "headless/cli/progress.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

namespace collidoscope {
namespace {

TEST(Progress, SaysShareRateAndTimeLeft) {
  const std::string line = progress_line("steps", 150, 300, 2, 100);
  EXPECT_EQ(line, "steps [####################--------------------]  50 %  150/300  75.0/s  0:02 left");
  EXPECT_THAT(progress_line("steps", 300, 300, 4, 100), testing::EndsWith("100 %  300/300  75.0/s"));
  EXPECT_THAT(progress_line("steps", 1, 10'000, 1, 100), testing::HasSubstr("2:46:39 left"));
}

TEST(Progress, IsNeverLongerThanTheTerminal) {
  for (int width = 0; width < 200; ++width)
    for (const std::int64_t total : {0LL, 1LL, 7LL, 1'000'000'000LL})
      for (const std::int64_t done : {std::int64_t{0}, total / 2, total})
        EXPECT_LE(progress_line("steps", done, total, 1e6, width).size(), static_cast<std::size_t>(width));
}

TEST(Progress, ATerminalIsDrawnOnAndLeftClean) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0)
    GTEST_SKIP() << "no pseudo-terminals";
  const winsize size{.ws_row = 10, .ws_col = 40, .ws_xpixel = 0, .ws_ypixel = 0};
  ASSERT_EQ(ioctl(terminal, TIOCSWINSZ, &size), 0);
  std::FILE* stream = std::fopen(ptsname(terminal), "w");
  ASSERT_NE(stream, nullptr);
  {
    Progress progress("steps", 10, stream);
    EXPECT_TRUE(progress.visible());
    progress.update(5);
  }
  // A read may return any part of the written text.
  const std::string wiped = "\r\x1b[K";
  std::string drawn;
  pollfd ready{.fd = terminal, .events = POLLIN, .revents = 0};
  while (!drawn.ends_with(wiped) && poll(&ready, 1, 2000) == 1) {
    char text[512];
    const auto length = read(terminal, text, sizeof text);
    if (length <= 0) break;
    drawn.append(text, static_cast<std::size_t>(length));
  }
  std::fclose(stream);
  close(terminal);
  EXPECT_THAT(drawn, testing::StartsWith("\rsteps"));
  EXPECT_THAT(drawn, testing::EndsWith(wiped));
  EXPECT_LE(drawn.find('\x1b'), 40u);
}

TEST(Progress, APipeSeesNothing) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  std::FILE* stream = fdopen(ends[1], "w");
  {
    Progress progress("steps", 10, stream);
    EXPECT_FALSE(progress.visible());
    progress.update(5);
  }
  std::fclose(stream);
  char byte;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

}  // namespace
}  // namespace collidoscope
