#pragma once
// The command line as a whole: which command, on what, with which options; or text that was asked for.

#include <optional>
#include <string>
#include <vector>

#include "headless/cli/options.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/world.h"

namespace collidoscope {

struct CommandLine {
  Command command = Command::run;
  std::string suite;                  ///< of bench; one of suites()
  std::vector<std::string> operands;  ///< of compare two pictures, else the scene
  Options options;
  std::string text;  ///< not empty: print this and do nothing else (--help, --version)
};

/// Reads the arguments that follow the program's name. Throws InputError with a line for each fault.
CommandLine parse_command_line(const std::vector<std::string>& arguments);
/// The same for the desktop program, which has one command; a scene that is not named is the Box Collider.
CommandLine parse_viewer_line(const std::vector<std::string>& arguments);

/// The scene of `run`, `capture`, `bench` and the viewer, with its overrides. Throws InputError.
Scene load_scene(const CommandLine& line);

/// Where a run starts: at state 0 of a scene, or at a snapshot, with the overrides in either case.
struct Start {
  Scene scene;
  std::optional<Snapshot> snapshot;  ///< that --load names
  World world(const RunOptions& options) const;
};
/// Throws InputError.
Start load_start(const CommandLine& line);

/// The file of a scene that was given as a path or as the bare name of one in assets/scenes, or in the folder
/// `analytic` there. Throws InputError, which names the scenes there are.
std::string scene_file(const std::string& given);

}  // namespace collidoscope
