#include "sim_cuda/stability/hard_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view ending = ".criterion.json";

void append(std::vector<std::string>& lines, const InputError& error) {
  lines.insert(lines.end(), error.lines().begin(), error.lines().end());
}

void read_others(HardCase& hard_case, std::vector<std::string>& faults) {
  std::vector<std::string> names;
  for (const Assertion& assertion : hard_case.criterion.assertions) names.push_back(assertion.scene);
  for (const InjectedFault& fault : hard_case.criterion.injected_faults) names.push_back(fault.scene);
  for (const std::string& name : names) {
    if (name.empty() || hard_case.others.contains(name)) continue;
    try {
      hard_case.others[name] = read_scene(hard_case.sibling_path(name));
    } catch (const InputError& error) {
      append(faults, error);
    }
  }
}

/// Checks that require a trial: settings of faults, and changes.
void try_out(const HardCase& hard_case, std::vector<std::string>& faults) {
  const Criterion& criterion = hard_case.criterion;
  for (std::size_t k = 0; k < criterion.injected_faults.size(); ++k) {
    if (!criterion.injected_faults[k].set) continue;
    for (const Fault& fault : validate(with_injected_fault(hard_case, criterion.injected_faults[k])))
      faults.push_back(fmt::format("{}: faults[{}].set: {}", criterion.file, k, line_of(fault)));
  }
  if (criterion.changes.empty()) return;
  try {
    read_changes(hard_case.sibling_path(criterion.changes), hard_case.scene, RunOptions{}, 0);
  } catch (const InputError& error) {
    append(faults, error);
  }
}

HardCase read_case(const std::string& folder, const std::string& name) {
  HardCase hard_case;
  hard_case.name = name;
  hard_case.file = (fs::path(folder) / (name + ".json")).string();
  const std::string criterion = (fs::path(folder) / (name + std::string(ending))).string();
  try {
    hard_case.scene = read_scene(hard_case.file);
  } catch (const InputError& error) {
    hard_case.refusal = error.lines();
  }
  std::vector<std::string> faults;
  try {
    hard_case.criterion = read_criterion(criterion, hard_case.refusal.empty() ? &hard_case.scene : nullptr);
    if (!hard_case.refusal.empty() && hard_case.criterion.refused.empty()) faults = hard_case.refusal;
  } catch (const InputError& error) {
    append(faults, error);
  }
  if (faults.empty()) read_others(hard_case, faults);
  if (faults.empty() && hard_case.refusal.empty()) try_out(hard_case, faults);
  if (!faults.empty()) throw InputError(faults);
  return hard_case;
}

std::size_t place_of(const std::string& group) {
  return static_cast<std::size_t>(std::ranges::find(hard_case_groups, group) - hard_case_groups.begin());
}

}  // namespace

std::string HardCase::sibling_path(const std::string& other) const {
  return (fs::path(file).parent_path() / other).string();
}

std::vector<std::string> hard_case_names(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string file = entry.path().filename().string();
    if (file.ends_with(ending)) names.push_back(file.substr(0, file.size() - ending.size()));
  }
  if (failed) throw InputError(fmt::format("{}: {}; give a folder of hard cases", folder, failed.message()));
  if (names.empty())
    throw InputError(fmt::format("{}: contains no case; expected NAME.json and NAME{}", folder, ending));
  std::ranges::sort(names);
  return names;
}

std::vector<HardCase> read_hard_cases(const std::string& folder, const std::vector<std::string>& names) {
  const std::vector<std::string> known = hard_case_names(folder);
  const std::vector<std::string_view> words(known.begin(), known.end());
  std::vector<std::string> wanted = names.empty() ? known : names, faults;
  std::ranges::sort(wanted);
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::vector<HardCase> cases;
  for (const std::string& name : wanted) {
    if (!std::ranges::binary_search(known, name)) {
      faults.push_back(unknown_name("hard case", name, words));
      continue;
    }
    try {
      cases.push_back(read_case(folder, name));
    } catch (const InputError& error) {
      append(faults, error);
    }
  }
  if (!faults.empty()) throw InputError(faults);
  std::ranges::sort(cases, [](const HardCase& a, const HardCase& b) {
    const auto place_a = place_of(a.criterion.group), place_b = place_of(b.criterion.group);
    // Numeric order: a stack of 50 comes before one of 100.
    return place_a != place_b ? place_a < place_b : strverscmp(a.name.c_str(), b.name.c_str()) < 0;
  });
  return cases;
}

Scene with_injected_fault(const HardCase& hard_case, const InjectedFault& fault) {
  if (!fault.scene.empty()) return hard_case.others.at(fault.scene);
  Scene scene = hard_case.scene;
  if (!fault.set) return scene;
  Change change;
  change.settings = *fault.set;
  RunOptions unchanged;
  apply_change(change, scene, unchanged);
  return scene;
}

}  // namespace collidoscope
