#include "headless/replay.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "sim_cuda/recording/replay.h"

namespace collidoscope {
namespace {

std::string json_of_replay(const RecordingReader& recording, const ReplayResult& result) {
  nlohmann::ordered_json report;
  report["file"] = recording.name();
  report["ended"] = recording.ended();
  report["states"] = result.states;
  report["changes"] = result.changes;
  report["keyframes"] = result.keyframes;
  report["agrees"] = !result.difference.has_value();
  return report.dump(2) + '\n';
}

std::string text_of_replay(const RecordingReader& recording, const ReplayResult& result) {
  return fmt::format("{}: {} states, {} changes and {} keyframes agree{}\n", recording.name(), result.states,
                     result.changes, result.keyframes,
                     recording.ended() ? "" : "; the recorded run did not end");
}

}  // namespace

int replay_command(const CommandLine& line) {
  const Options& options = line.options;
  const RecordingReader recording(line.operands[0]);
  std::optional<OutputFile> json;
  if (!options.json.empty() && options.json != "-") json.emplace("--json", options.json);
  std::int64_t states = 0;
  for (const RecordingReader::Event& event : recording.events()) states += std::ssize(event.hashes);
  ReplayResult result;
  {
    Progress progress("states", states);
    result = replay(recording, options.run, [&](std::int64_t done) { progress.update(done); });
  }
  if (recording.valid_bytes() < recording.bytes())
    fmt::print(stderr, "note: {}: byte {}: the last chunk is incomplete and was left out\n", recording.name(),
               recording.valid_bytes());
  if (json) {
    json->write(json_of_replay(recording, result));
    json->commit();
  }
  print(options.json == "-" ? json_of_replay(recording, result) : text_of_replay(recording, result));
  if (!result.difference) return 0;
  fmt::print(stderr, "{}\n", *result.difference);
  return 1;
}

}  // namespace collidoscope
