// Tests that the window uses the X server within a Wayland session.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "tests/viewer_fixture.h"

namespace collidoscope {
namespace {

/// A compositor that accepts connections and never answers.
class SilentCompositor {
 public:
  SilentCompositor() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = (folder_ / "wayland-silent").string();
    if (path.size() >= sizeof address.sun_path) throw std::runtime_error(path + " is too long for a socket");
    std::copy(path.begin(), path.end(), address.sun_path);
    if (socket_ < 0 || bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        listen(socket_, 8) != 0)
      throw std::runtime_error("no socket " + path);
  }
  ~SilentCompositor() { close(socket_); }
  SilentCompositor(const SilentCompositor&) = delete;
  SilentCompositor& operator=(const SilentCompositor&) = delete;

  WindowDriver::Environment session() const {
    return {{"XDG_SESSION_TYPE", "wayland"},
            {"XDG_RUNTIME_DIR", folder_.path().string()},
            {"WAYLAND_DISPLAY", "wayland-silent"}};
  }

 private:
  TemporaryFolder folder_;
  int socket_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
};

TEST_F(Viewer, UsesTheXServerOfAWaylandSession) {
  // By default GLFW 3.4 connects to this compositor and waits for its answer.
  const SilentCompositor compositor;
  WindowDriver window({"one_body", "--steps", "1"}, compositor.session());
  ASSERT_TRUE(window.wait_for([](const Json& f) { return f["playing"] == false && f["step"] == 1; }));
  window.key("s");
  EXPECT_TRUE(window.wait_for([](const Json& f) { return f["step"] == 2; }));
  EXPECT_EQ(close(window), "");
}

}  // namespace
}  // namespace collidoscope
