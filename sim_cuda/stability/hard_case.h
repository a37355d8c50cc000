#pragma once
// A hard case: a scene that tries to break the simulation, `NAME.json`, and beside it what must hold of it,
// `NAME.criterion.json`. Plain data, read from a folder of them.

#include <map>
#include <string>
#include <vector>

#include "sim_cuda/scene/scene.h"
#include "sim_cuda/stability/criterion.h"

namespace collidoscope {

struct HardCase {
  std::string name;
  std::string file;  ///< of the scene
  Scene scene;       ///< empty where it was refused
  Criterion criterion;
  std::vector<std::string> refusal;  ///< lines in which the scene was refused, as its criterion says it must
  std::map<std::string, Scene> others;  ///< that the criterion names, by the names it has for them

  std::string sibling_path(const std::string& other) const;  ///< the path of a file in the same folder
};

/// Names of the cases in a folder, sorted. Throws InputError where there is no such folder, or no case in it.
std::vector<std::string> hard_case_names(const std::string& folder);

/// Reads these, or, without names, all; by group, and then by name. Throws InputError with the faults of all
/// their files; an unknown name is one, with the names that are near.
std::vector<HardCase> read_hard_cases(const std::string& folder, const std::vector<std::string>& names = {});

/// The scene with the settings of a fault.
Scene with_injected_fault(const HardCase& hard_case, const InjectedFault& fault);

}  // namespace collidoscope
