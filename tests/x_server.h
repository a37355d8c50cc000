#pragma once
// What xdotool cannot do with a window: the close request of a window manager, drag and drop, its colours.
// Loads libX11 by name, as nothing else needs it.

#include <X11/Xlib.h>
#include <dlfcn.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>

namespace collidoscope {

class XServer {
 public:
  explicit XServer(const std::string& display) : library_(dlopen("libX11.so.6", RTLD_NOW)) {
    if (library_ != nullptr) display_ = function<decltype(XOpenDisplay)>("XOpenDisplay")(display.c_str());
    if (display_ == nullptr) throw std::runtime_error("libX11 finds no display");
  }
  ~XServer() { function<decltype(XCloseDisplay)>("XCloseDisplay")(display_); }
  XServer(const XServer&) = delete;
  XServer& operator=(const XServer&) = delete;

  void ask_to_close(::Window window) {
    const auto atom = [this](const char* name) {
      return function<decltype(XInternAtom)>("XInternAtom")(display_, name, False);
    };
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = window;
    event.xclient.message_type = atom("WM_PROTOCOLS");
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(atom("WM_DELETE_WINDOW"));
    function<decltype(XSendEvent)>("XSendEvent")(display_, window, False, NoEventMask, &event);
    function<decltype(XSync)>("XSync")(display_, False);
  }

  /// The source's side of drag and drop in X11: XDND, version 5.
  void drop(::Window target, int x, int y, const std::string& path) {
    const auto atom = [this](const char* name) {
      return function<decltype(XInternAtom)>("XInternAtom")(display_, name, False);
    };
    const ::Window source = function<decltype(XCreateSimpleWindow)>("XCreateSimpleWindow")(
        display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
    const Atom selection = atom("XdndSelection"), type = atom("text/uri-list");
    function<decltype(XSetSelectionOwner)>("XSetSelectionOwner")(display_, selection, source, CurrentTime);
    const auto send = [&](const char* message, long second, long third, long fourth, long fifth) {
      XEvent event{};
      event.xclient.type = ClientMessage;
      event.xclient.window = target;
      event.xclient.message_type = atom(message);
      event.xclient.format = 32;
      const long words[] = {static_cast<long>(source), second, third, fourth, fifth};
      std::copy(std::begin(words), std::end(words), event.xclient.data.l);
      function<decltype(XSendEvent)>("XSendEvent")(display_, target, False, NoEventMask, &event);
    };
    send("XdndEnter", 5L << 24, static_cast<long>(type), 0, 0);
    send("XdndPosition", 0, static_cast<long>(x) << 16 | y, CurrentTime,
         static_cast<long>(atom("XdndActionCopy")));
    send("XdndDrop", 0, CurrentTime, 0, 0);
    const std::string uri = "file://" + path + "\r\n";
    while (true) {  // the program's alarm ends a window that does not answer
      XEvent event{};
      function<decltype(XNextEvent)>("XNextEvent")(display_, &event);
      if (event.type == SelectionRequest) {
        const XSelectionRequestEvent& request = event.xselectionrequest;
        function<decltype(XChangeProperty)>("XChangeProperty")(
            display_, request.requestor, request.property, request.target, 8, PropModeReplace,
            reinterpret_cast<const unsigned char*>(uri.data()), static_cast<int>(uri.size()));
        XEvent answer{};
        answer.xselection.type = SelectionNotify;
        answer.xselection.requestor = request.requestor;
        answer.xselection.selection = request.selection;
        answer.xselection.target = request.target;
        answer.xselection.property = request.property;
        answer.xselection.time = request.time;
        function<decltype(XSendEvent)>("XSendEvent")(display_, request.requestor, False, NoEventMask,
                                                     &answer);
      }
      if (event.type == ClientMessage && event.xclient.message_type == atom("XdndFinished")) return;
    }
  }

  std::size_t colors_of(::Window window) {
    XWindowAttributes size{};
    function<decltype(XGetWindowAttributes)>("XGetWindowAttributes")(display_, window, &size);
    XImage* const image =
        function<decltype(XGetImage)>("XGetImage")(display_, window, 0, 0, static_cast<unsigned>(size.width),
                                                   static_cast<unsigned>(size.height), AllPlanes, ZPixmap);
    if (image == nullptr) return 0;
    std::set<unsigned long> colors;
    for (int y = 0; y < image->height; ++y)
      for (int x = 0; x < image->width; ++x) colors.insert(image->f.get_pixel(image, x, y));
    image->f.destroy_image(image);
    return colors.size();
  }

 private:
  template <class Function>
  Function* function(const char* name) {
    return reinterpret_cast<Function*>(dlsym(library_, name));
  }
  void* library_;
  Display* display_ = nullptr;
};

}  // namespace collidoscope
