#include "sim_cuda/recording/recording_chunks.h"

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/run/run_state.h"

namespace collidoscope {
namespace {

std::string_view bytes_of_number(const std::int64_t& number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

}  // namespace

void write_meta_chunk(RecordingWriter& writer, const World& world) {
  const WorldInfo info = world.info();
  nlohmann::ordered_json meta;
  meta["program"] = "collidoscope";
  meta["physics_version"] = physics_version;
  meta["scene"] = world.scene().name;
  meta["executor"] = info.on_gpu ? "cuda" : "cpu";
  meta["device"] = info.device_name;
  meta["broad_phase"] = world.options().broad_phase;
  writer.write(chunk_types::meta, meta.dump());
}

void write_keyframe_chunk(RecordingWriter& writer, const Snapshot& snapshot) {
  writer.write(chunk_types::keyframe, [&](const RecordingWriter::Sink& sink) {
    sink(bytes_of_number(snapshot.state.steps));
    sink(bytes_of_number(static_cast<std::int64_t>(full_hash(snapshot.state))));
    write_snapshot(snapshot, sink);
  });
}

void write_hashes_chunk(RecordingWriter& writer, std::int64_t first, std::span<const StateHashes> hashes) {
  writer.write(chunk_types::hashes, [&](const RecordingWriter::Sink& sink) {
    sink(bytes_of_number(first));
    sink({reinterpret_cast<const char*>(hashes.data()), hashes.size_bytes()});
  });
}

void write_change_chunk(RecordingWriter& writer, const Change& change, const Scene& before) {
  const std::string text = write_changes({{change}, std::nullopt}, before);
  writer.write(chunk_types::change, std::string(bytes_of_number(change.step)) + text);
}

}  // namespace collidoscope
