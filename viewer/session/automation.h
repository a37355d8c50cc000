#pragma once
// Output of --automation, for tests that use mouse and keyboard. One line of JSON per drawn frame: state of
// the run, and position of each visible widget. Owns the file.

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "ui/workspace.h"

namespace collidoscope {

class Automation {
 public:
  /// Throws InputError if the file cannot be opened.
  explicit Automation(const std::string& file);

  struct Frame {
    std::int64_t frame = 0;
    bool complete = true;                               ///< the panels and the picture show one state
    std::int64_t releases = 0;                          ///< of keys and buttons, since the start
    int width = 0, height = 0;                          ///< pixels of the window
    std::optional<std::uint64_t> state_hash;            ///< only while paused
    double camera[6] = {};                              ///< target, azimuth, elevation, distance
    double ui_ms = 0;                                   ///< time for the panels
    std::string picture;                                ///< name of the last written picture
    std::int64_t spheres = 0, boxes = 0, contacts = 0;  ///< numbers of drawn records
    bool wants_mouse = false;                           ///< the pointer is over a panel
    bool list_open = false;                             ///< a drop-down list is open
  };
  /// Throws MachineError if the line cannot be written (disk full).
  void write(const Frame& frame, const Workspace& workspace, const WorkspaceView& view);

 private:
  std::string file_;
  std::ofstream stream_;
};

}  // namespace collidoscope
