#include "sim_cuda/broad_phase/pair_check.h"

#include <fmt/format.h>

namespace collidoscope {
namespace {

constexpr const char* fault_names[pair_faults] = {"missing", "duplicate", "out of range", "apart"};
constexpr int shown_pairs = 5;

}  // namespace

const char* name_of(PairFault fault) { return fault_names[static_cast<std::size_t>(fault)]; }

std::string note_of(const PairCheck& check) {
  return short_note_of(check) + (check.is_wrong() ? ": " + describe(check) : "");
}

std::string short_note_of(const PairCheck& check) {
  if (check.is_wrong()) return "plug-in, WRONG PAIRS";
  if (!check.compares) return "plug-in, pairs not compared";
  return fmt::format("plug-in, pairs compared in {} runs", check.runs);
}

std::string describe(const PairCheck& check) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  for (std::size_t k = 0; k < pair_faults; ++k) {
    if (check.pairs[k] == 0 || static_cast<PairFault>(k) == PairFault::apart) continue;
    std::string part = fmt::format("{} {}", check.pairs[k], fault_names[k]);
    int shown = 0;
    for (const FaultyPair& each : check.examples)
      if (static_cast<std::size_t>(each.fault) == k && shown < shown_pairs)
        part += fmt::format("{}{}-{}", shown++ == 0 ? ", such as " : ", ", each.a, each.b);
    add(part);
  }
  if (check.writes_beyond > 0)
    add(fmt::format("runs with writes beyond the capacity: {}", check.writes_beyond));
  if (check.absurd_counts > 0)
    add(fmt::format("runs with more pairs than a list can have: {}", check.absurd_counts));
  if (check.wrong_runs > 0)
    text +=
        fmt::format(" (in {} of {} runs, first in run {})", check.wrong_runs, check.runs, check.first_wrong);
  for (const std::string& line : check.tree_faults) add(line);
  return text;
}

}  // namespace collidoscope
