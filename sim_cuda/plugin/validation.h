#pragma once
// Tests a broad-phase plug-in in a process of its own, so that a crash or an endless loop of its code does
// not reach this process. The pairs of many sets of boxes are compared with those of brute force.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace collidoscope {

struct PluginTest {
  std::string name;        ///< of the set of boxes, with the executor
  std::int64_t boxes = 0;  ///< number
  std::int64_t pairs = 0;  ///< expected
  std::string fault;       ///< one line; empty: passed
};

struct PluginValidation {
  std::string path, name;  ///< of the library and of its broad phase
  std::string identity;    ///< file_identity() before the tests
  std::vector<PluginTest> tests;
  std::string ended;  ///< why the process ended before all tests, such as "crashed with ..."; else empty

  bool passed() const;
  /// A line for each test that failed, without the path.
  std::vector<std::string> faults() const;
};

struct ValidationOptions {
  double timeout = 20;                     ///< s, for one test; then the process is ended
  int gpu = 0;                             ///< of libraries for CUDA
  std::string program = "/proc/self/exe";  ///< its main() calls run_validation_child()
  std::function<void()> poll = [] {};      ///< called every tenth of a second; may throw
};

/// `path`: from full_plugin_path(). Throws InputError if it is not a plug-in. Throws MachineError if the
/// process cannot be started.
PluginValidation validate_plugin(const std::string& path, const ValidationOptions& options);

/// Call first in main(), with the arguments after the program's name. If this is the process of
/// validate_plugin(), runs the tests and returns the exit status.
std::optional<int> run_validation_child(std::span<const std::string> arguments);

}  // namespace collidoscope
