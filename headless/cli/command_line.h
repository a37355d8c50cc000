#pragma once
// The command line as a whole: which command, on what, with which options; or text that was asked for.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "headless/cli/options.h"
#include "sim_cuda/import/body_table.h"
#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/world.h"

namespace collidoscope {

struct CommandLine {
  Command command = Command::run;
  std::string suite;                  ///< of bench; the name of one
  std::vector<std::string> operands;  ///< of compare two pictures, else the scene
  Options options;
  std::string text;  ///< not empty: print this and do nothing else (--help, --version)
};

/// A suite of `bench`.
struct Suite {
  const char* name;
  const char* help;
  std::string_view flags;  ///< those it reads of the ones that bench has and run has not
  /// The suite's operands are a scene, or nothing; flags are those of `bench`. Returns the exit status;
  /// throws InputError or MachineError, and has written nothing then.
  int (*run)(const CommandLine& line);
};
/// A command of collidoscope-headless, for man pages and completion.
struct CommandText {
  std::string name, usage, help;
  Command command;
};
std::vector<CommandText> command_texts();
/// Reads the arguments that follow the program's name; `suites` are those of bench. Throws InputError with a
/// line for each fault.
CommandLine parse_command_line(const std::vector<std::string>& arguments, std::span<const Suite> suites = {});
/// The same for the desktop program, which has one command; a scene that is not named is the Box Collider.
CommandLine parse_viewer_line(const std::vector<std::string>& arguments);

/// The scene of `run`, `capture`, `bench` and the viewer, with its overrides. Throws InputError.
Scene load_scene(const CommandLine& line);

/// Where a run starts: at state 0 of a scene, or at a snapshot, with the overrides in either case.
struct Start {
  Scene scene;
  std::optional<Snapshot> snapshot;  ///< that --load names
  /// The file of the snapshot, if it is a recording whose states can all be reached again.
  std::shared_ptr<const RecordingReader> recording{};
  bool imported = false;            ///< the scene is made of a file of bodies
  std::vector<BodyTable> frames{};  ///< of an imported scene with several, for the window; state k is frame k
  World world(const RunOptions& options) const;
  bool has_boxes() const { return scene.body_files.size() == 1 && scene.body_files[0].boxes; }
};
/// What an import assumed, in one line without the name of the file.
std::string imported_notice(const Scene& scene);
/// Throws InputError.
Start load_start(const CommandLine& line);

/// The file of a scene that was given as a path or as the bare name of one in assets/scenes, or in the folder
/// `analytic` there. Throws InputError, which names the scenes there are.
std::string scene_file(const std::string& given);

}  // namespace collidoscope
