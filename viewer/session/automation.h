#pragma once
// What a test that drives the window by its mouse and keys reads: one line of JSON for every drawn frame,
// with the state of the run and the place of every widget that can be seen. Owns the file.

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "ui/workspace.h"

namespace collidoscope {

class Automation {
 public:
  /// Throws InputError where the file cannot be opened.
  explicit Automation(const std::string& file);

  struct Frame {
    std::int64_t frame = 0;
    int width = 0, height = 0;                          ///< pixels of the window
    std::optional<std::uint64_t> state_hash;            ///< where it is known: when paused
    double camera[6] = {};                              ///< target, azimuth, elevation, distance
    double ui_ms = 0;                                   ///< what the panels took
    std::string picture;                                ///< the last one written
    std::int64_t spheres = 0, boxes = 0, contacts = 0;  ///< drawn
    bool wants_mouse = false;                           ///< the pointer is over a panel
    bool list_open = false;                             ///< a list to choose from is unfolded
  };
  /// Throws MachineError where the line cannot be written (a full disk).
  void write(const Frame& frame, const Workspace& workspace, const WorkspaceView& view);

 private:
  std::string file_;
  std::ofstream stream_;
};

}  // namespace collidoscope
