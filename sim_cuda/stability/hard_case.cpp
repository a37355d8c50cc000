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

void read_others(HardCase& one, std::vector<std::string>& faults) {
  std::vector<std::string> names;
  for (const Term& term : one.criterion.holds) names.push_back(term.scene);
  for (const CriterionFault& fault : one.criterion.faults) names.push_back(fault.scene);
  for (const std::string& name : names) {
    if (name.empty() || one.others.contains(name)) continue;
    try {
      one.others[name] = read_scene(one.beside(name));
    } catch (const InputError& error) {
      append(faults, error);
    }
  }
}

/// What only shows when it is tried: settings of faults, changes.
void try_out(const HardCase& one, std::vector<std::string>& faults) {
  const Criterion& criterion = one.criterion;
  for (std::size_t k = 0; k < criterion.faults.size(); ++k) {
    if (!criterion.faults[k].set) continue;
    for (const Fault& fault : validate(with_fault(one, criterion.faults[k])))
      faults.push_back(fmt::format("{}: faults[{}].set: {}", criterion.file, k, line_of(fault)));
  }
  if (criterion.changes.empty()) return;
  try {
    read_changes(one.beside(criterion.changes), one.scene, RunOptions{}, 0);
  } catch (const InputError& error) {
    append(faults, error);
  }
}

HardCase read_case(const std::string& folder, const std::string& name) {
  HardCase one;
  one.name = name;
  one.file = (fs::path(folder) / (name + ".json")).string();
  const std::string criterion = (fs::path(folder) / (name + std::string(ending))).string();
  try {
    one.scene = read_scene(one.file);
  } catch (const InputError& error) {
    one.refusal = error.lines();
  }
  std::vector<std::string> faults;
  try {
    one.criterion = read_criterion(criterion, one.refusal.empty() ? &one.scene : nullptr);
    if (!one.refusal.empty() && one.criterion.refused.empty()) faults = one.refusal;
  } catch (const InputError& error) {
    append(faults, error);
  }
  if (faults.empty()) read_others(one, faults);
  if (faults.empty() && one.refusal.empty()) try_out(one, faults);
  if (!faults.empty()) throw InputError(faults);
  return one;
}

std::size_t place_of(const std::string& group) {
  return static_cast<std::size_t>(std::ranges::find(hard_case_groups, group) - hard_case_groups.begin());
}

}  // namespace

std::string HardCase::beside(const std::string& other) const {
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
    throw InputError(fmt::format("{}: holds no case, which is a NAME.json and a NAME{}", folder, ending));
  std::ranges::sort(names);
  return names;
}

std::vector<HardCase> read_hard_cases(const std::string& folder, const std::vector<std::string>& names) {
  const std::vector<std::string> known = hard_case_names(folder);
  const std::vector<std::string_view> words(known.begin(), known.end());
  std::vector<std::string> wanted = names.empty() ? known : names, faults;
  std::ranges::sort(wanted);
  wanted.erase(std::ranges::unique(wanted).begin(), wanted.end());
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
    // A stack of 50 comes before one of 100.
    return place_a != place_b ? place_a < place_b : strverscmp(a.name.c_str(), b.name.c_str()) < 0;
  });
  return cases;
}

Scene with_fault(const HardCase& one, const CriterionFault& fault) {
  if (!fault.scene.empty()) return one.others.at(fault.scene);
  Scene scene = one.scene;
  if (!fault.set) return scene;
  Change change;
  change.settings = *fault.set;
  RunOptions unchanged;
  make_change(change, scene, unchanged);
  return scene;
}

}  // namespace collidoscope
