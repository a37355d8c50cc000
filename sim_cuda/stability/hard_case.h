#pragma once
// A hard case: a stress test that consists of a scene, `NAME.json`, and its criterion, `NAME.criterion.json`.
// Plain data, read from a folder.

#include <map>
#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"
#include "sim_cuda/stability/criterion.h"

namespace collidoscope {

struct HardCase {
  std::string name;
  std::string file;  ///< scene file
  Scene scene;       ///< empty if the scene was rejected
  Criterion criterion;
  std::vector<std::string> refusal;     ///< error lines of a scene that is rejected as expected
  std::map<std::string, Scene> others;  ///< other scenes of the criterion, by the names used there

  std::string sibling_path(const std::string& other) const;  ///< path of a file in the same folder
};

/// Sorted names of the cases in a folder. Throws InputError if the folder does not exist or has no case.
std::vector<std::string> hard_case_names(const std::string& folder);

/// Reads the named cases, or all if `names` is empty. Sorted by group, then by name. Throws InputError with
/// the faults of all files, and with suggestions for unknown names.
std::vector<HardCase> read_hard_cases(const std::string& folder, const std::vector<std::string>& names = {});

/// The scene with the settings of an injected fault.
Scene with_injected_fault(const HardCase& hard_case, const InjectedFault& fault);

}  // namespace collidoscope
