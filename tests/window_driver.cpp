#include "tests/window_driver.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "sim_cuda/core/assets.h"
#include "tests/screen_picture.h"
#include "tests/x_server.h"

namespace collidoscope {
namespace {

using Clock = std::chrono::steady_clock;

void pause_for(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string rest = path ? path : "";
  while (!rest.empty()) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    if (access((rest.substr(0, colon) + "/" + program).c_str(), X_OK) == 0) return true;
    rest.erase(0, colon + 1);
  }
  return false;
}

}  // namespace

std::string window_tests_unavailable_reason() {
  for (const char* program : {"Xvfb", "xdotool"})
    if (!on_path(program)) return std::string(program) + " is not installed (./dev test installs it)";
  if (!std::filesystem::exists(program_folder() / "collidoscope")) return "the viewer was not built";
  return "";
}

pid_t WindowDriver::start(const std::vector<std::string>& command, const std::string& out,
                          const std::string& err) {
  const pid_t child = fork();
  if (child != 0) return child;
  const auto redirect = [](const std::string& file, int flags, int to) {
    const int from = open(file.c_str(), flags, 0600);
    if (from < 0 || dup2(from, to) < 0) _exit(126);
    close(from);
  };
  redirect("/dev/null", O_RDONLY, STDIN_FILENO);
  redirect(out, O_WRONLY | O_CREAT | O_APPEND, STDOUT_FILENO);
  redirect(err, O_WRONLY | O_CREAT | O_APPEND, STDERR_FILENO);
  setenv("DISPLAY", display_.c_str(), 1);
  setenv("XDG_CONFIG_HOME", file("config").c_str(), 1);
  setenv("XDG_CACHE_HOME", file("cache").c_str(), 1);
  setenv("XDG_SESSION_TYPE", "x11", 1);
  // The cache would be empty in this new folder. Its threads have the lowest priority, so that on a busy
  // machine the program needs seconds to end.
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  unsetenv("WAYLAND_DISPLAY");
  for (const auto& [name, value] : environment_) setenv(name.c_str(), value.c_str(), 1);
  if (chdir(file(".").c_str()) != 0) _exit(126);
  std::vector<char*> argv;
  for (const std::string& argument : command) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  _exit(127);
}

WindowDriver::WindowDriver(const std::vector<std::string>& arguments, Environment environment, Wait wait)
    : environment_(std::move(environment)) {
  // Xvfb chooses a free display and prints its number.
  server_ = start({"Xvfb", "-displayfd", "1", "-screen", "0", "1920x1200x24", "-nolisten", "tcp", "-nocursor",
                   "-fbdir", file(".")},
                  file("display"), file("xvfb.err"));
  for (int tries = 0; tries < 200 && display_.empty(); ++tries) {
    pause_for(0.05);
    std::ifstream stream(file("display"));
    std::string number;
    if (std::getline(stream, number) && stream.good() && !number.empty()) display_ = ":" + number;
  }
  if (display_.empty()) throw std::runtime_error("Xvfb did not start");
  std::vector<std::string> command{(program_folder() / "collidoscope").string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  command.insert(command.end(), {"--automation", file("automation.jsonl")});
  program_ = start(command, file("out"), file("err"));
  if (wait == Wait::for_window) {
    hands({"search", "--sync", "--onlyvisible", "--name", "Collidoscope"});
    return;
  }
  if (!wait_for([](const Json&) { return true; }, 60))
    throw std::runtime_error("the viewer drew no frame: " + errors());
}

WindowDriver::~WindowDriver() {
  for (pid_t* child : {&program_, &server_}) {
    if (*child <= 0) continue;
    kill(*child, SIGKILL);
    waitpid(*child, nullptr, 0);
  }
}

namespace {

std::int64_t number_after(std::string_view line, std::string_view key) {
  const std::size_t at = line.find(key);
  if (at == line.npos) throw std::runtime_error("no " + std::string(key) + " in a frame");
  return std::strtoll(line.data() + at + key.size(), nullptr, 10);
}

}  // namespace

void WindowDriver::read_lines() {
  std::ifstream stream(file("automation.jsonl"), std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(read_to_));
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  read_to_ += text.size();
  partial_ += text;
  const std::size_t end = partial_.rfind('\n');
  if (end == std::string::npos) return;
  for (std::size_t to = end; to != std::string::npos;) {  // from the newest line back
    const std::size_t before = to == 0 ? std::string::npos : partial_.rfind('\n', to - 1);
    const std::size_t from = before == std::string::npos ? 0 : before + 1;
    const std::string_view line = std::string_view(partial_).substr(from, to - from);
    if (to == end) {
      newest_ = number_after(line, R"("frame":)");
      releases_ = number_after(line, R"("releases":)");
    }
    if (line.find(R"("complete":true)") != line.npos) {
      frame_ = Json::parse(line);
      break;
    }
    to = before;
  }
  partial_.erase(0, end + 1);
}

const WindowDriver::Json& WindowDriver::frame() {
  read_lines();
  return frame_;
}

const WindowDriver::Json& WindowDriver::next_frame() {
  // The second next frame: the next one may have read its events already.
  read_lines();
  const std::int64_t now = newest_;
  wait_for([now](const Json& f) { return f["frame"] > now + 1; });
  return frame_;
}

void WindowDriver::input(const std::vector<std::string>& xdotool, std::int64_t releases) {
  read_lines();
  const std::int64_t expected = releases_ + releases;
  hands(xdotool);
  const auto end = Clock::now() + std::chrono::seconds(30);
  while (releases_ < expected && Clock::now() < end && running()) {
    pause_for(0.005);
    read_lines();
  }
  next_frame();
}

bool WindowDriver::running() {
  if (program_ <= 0) return false;
  int status = 0;
  if (waitpid(program_, &status, WNOHANG) != program_) return true;
  status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  program_ = -1;
  return false;
}

bool WindowDriver::wait_for(const std::function<bool(const Json&)>& so, double seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end && running()) {
    read_lines();
    if (!frame_.is_null() && so(frame_)) return true;
    pause_for(0.01);
  }
  return false;
}

int WindowDriver::end() {
  if (program_ > 0) kill(program_, SIGTERM);
  for (int tries = 0; tries < 1000 && running(); ++tries) pause_for(0.02);
  return status_;
}

unsigned long WindowDriver::window() {
  std::filesystem::remove(file("xdotool.out"));
  hands({"search", "--onlyvisible", "--name", "Collidoscope"});
  std::ifstream found(file("xdotool.out"));
  unsigned long window = 0;
  if (!(found >> window)) throw std::runtime_error("the window is not to be seen");
  return window;
}

void WindowDriver::drop_file(const std::string& path) {
  const Json& rect = frame()["widgets"]["scene"];
  XServer(display_).drop(window(), x_ + static_cast<int>(rect[0].get<double>() + 0.5 * rect[2].get<double>()),
                         y_ + static_cast<int>(rect[1].get<double>() + 0.5 * rect[3].get<double>()), path);
}

void WindowDriver::press_close_button() { XServer(display_).ask_to_close(window()); }

double WindowDriver::seconds_to_end(int& status, double most) {
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  while (running()) {
    if (seconds() > most) return -1;
    pause_for(0.005);
  }
  status = status_;
  return seconds();
}

void WindowDriver::send_signal(int number) {
  if (program_ > 0) kill(program_, number);
}

std::size_t WindowDriver::colors_shown() { return XServer(display_).colors_of(window()); }

bool WindowDriver::sees(const std::string& widget) { return frame()["widgets"].contains(widget); }

std::pair<int, int> WindowDriver::place(const std::string& widget) {
  if (!wait_for([&](const Json& f) { return f["widgets"].contains(widget); }, 10))
    throw std::runtime_error("there is no widget " + widget + " to be seen");
  const Json& rect = frame_["widgets"][widget];
  return {static_cast<int>(rect[0].get<double>() + 0.5 * rect[2].get<double>()),
          static_cast<int>(rect[1].get<double>() + 0.5 * rect[3].get<double>())};
}

void WindowDriver::hands(const std::vector<std::string>& xdotool) {
  std::vector<std::string> command{"xdotool"};
  command.insert(command.end(), xdotool.begin(), xdotool.end());
  const pid_t child = start(command, file("xdotool.out"), file("xdotool.err"));
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) throw std::runtime_error("xdotool " + xdotool[0] + " failed");
}

void WindowDriver::move(int x, int y) { hands({"mousemove", std::to_string(x), std::to_string(y)}); }

void WindowDriver::click_at(int x, int y, int button) {
  input({"mousemove", std::to_string(x), std::to_string(y), "click", std::to_string(button)}, 1);
}

void WindowDriver::click(const std::string& widget) {
  const auto [x, y] = place(widget);
  click_at(x, y);
}

void WindowDriver::key(const std::string& name) {
  input({"key", name}, 1 + std::count(name.begin(), name.end(), '+'));
}

void WindowDriver::type_into(const std::string& widget, const std::string& text) {
  click(widget);
  type(text);
}

void WindowDriver::type(const std::string& text) {
  key("ctrl+a");
  input({"type", "--", text}, std::ssize(text));
  key("Return");
}

void WindowDriver::drag(int from_x, int from_y, int to_x, int to_y, int button) {
  const std::string b = std::to_string(button);
  hands({"mousemove", std::to_string(from_x), std::to_string(from_y), "mousedown", b});
  next_frame();
  for (int k = 1; k <= 4; ++k) move(from_x + (to_x - from_x) * k / 4, from_y + (to_y - from_y) * k / 4);
  next_frame();
  input({"mouseup", b}, 1);
}

void WindowDriver::resize(int width, int height) {
  hands({"search", "--name", "Collidoscope", "windowsize", std::to_string(width), std::to_string(height)});
  wait_for([&](const Json& f) { return f["window"] == Json({width, height}); }, 20);
}

void WindowDriver::move_window(int x, int y) {
  hands({"search", "--name", "Collidoscope", "windowmove", "--sync", std::to_string(x), std::to_string(y)});
  x_ = x;
  y_ = y;
  next_frame();
}

Image WindowDriver::shown() {
  const Json size = frame()["window"];
  return screen_picture(file("Xvfb_screen0"), x_, y_, size[0], size[1]);
}

std::string WindowDriver::errors() {
  std::ifstream stream(file("err"), std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace collidoscope
