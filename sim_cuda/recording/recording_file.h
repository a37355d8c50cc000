#pragma once
// Recordings: a run in one file. A file is a sequence of chunks, each with type, version, length and hash;
// README.md describes them. A chunk is complete or absent: after a kill, the file is valid up to its last
// complete chunk. Chunks of unknown types are skipped.

#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/core/atomic_file.h"
#include "sim_cuda/core/state_hashes.h"
#include "sim_cuda/snapshot/snapshot.h"

namespace collidoscope {

inline constexpr std::uint32_t recording_version = 1;

using ChunkType = std::array<char, 4>;
namespace chunk_types {
inline constexpr ChunkType meta{'M', 'E', 'T', 'A'}, keyframe{'K', 'E', 'Y', 'F'}, change{'C', 'H', 'N', 'G'},
    hashes{'H', 'A', 'S', 'H'}, end{'E', 'N', 'D', ' '};
// Reserved for the data of other programs.
inline constexpr ChunkType shapes{'S', 'H', 'A', 'P'}, manifolds{'M', 'A', 'N', 'I'},
    pairs{'P', 'A', 'I', 'R'}, tree{'T', 'R', 'E', 'E'}, times{'T', 'I', 'M', 'E'};
}  // namespace chunk_types

/// Version of the chunk `hashes`. In version 1, StateHashes::full is full_hash() of the state on the host, or
/// 0.
inline constexpr std::uint32_t hashes_version = 2;

/// Whether the file begins as a recording.
bool is_recording(const std::string& file);

/// Appends chunks to a new file. All members throw MachineError with the reason of the operating system.
class RecordingWriter {
 public:
  /// Replaces an existing file. Throws InputError if the file cannot be created.
  explicit RecordingWriter(const std::string& file);
  /// Writes to `target`, which must outlive the writer, and does not commit it.
  explicit RecordingWriter(AtomicFile& target);

  using Sink = std::function<void(std::string_view)>;
  /// `write_payload` passes the payload to the sink, in pieces.
  void write(const ChunkType& type, const std::function<void(const Sink&)>& write_payload);
  void write(const ChunkType& type, std::string_view payload);

 private:
  void begin();
  void put(const void* data, std::size_t bytes);
  void seek(std::uint64_t to);
  void flush();
  [[noreturn]] void fail() const;

  std::string name_;
  AtomicFile* target_ = nullptr;  ///< closes `stream_`, if not null
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_{nullptr, &std::fclose};
  std::uint64_t end_ = 0;  ///< end of the last complete chunk
};

/// Reads the chunks of a file. Errors are InputErrors: "file: byte N: problem, expected value".
class RecordingReader {
 public:
  enum class Kind { keyframe, change, hashes };
  struct Event {
    Kind kind;
    std::int64_t step;                ///< of the keyframe, of the change, or before the first hash
    std::uint64_t full_hash = 0;      ///< of a keyframe
    std::uint32_t version = 1;        ///< of the chunk
    std::vector<StateHashes> hashes;  ///< of the states step + 1, step + 2, ...
    std::uint64_t begin, bytes;       ///< of the rest of the payload in the file
  };

  /// Reads all chunks except snapshots, and checks all hashes.
  explicit RecordingReader(const std::string& file);

  const std::string& name() const { return name_; }
  const std::string& meta() const { return meta_; }  ///< JSON about the recording program and its device
  /// In file order. The first one is a keyframe.
  const std::vector<Event>& events() const { return events_; }
  Snapshot keyframe(const Event& event) const;
  /// The text of a change, as a list of changes with one member (changes_file.h).
  std::string change(const Event& event) const;
  /// Where a message about an event begins: "file: byte N".
  std::string place(const Event& event) const;
  bool ended() const { return ended_; }  ///< the recording program ended the run
  std::uint64_t valid_bytes() const { return valid_bytes_; }
  std::uint64_t bytes() const { return bytes_; }  ///< more than valid_bytes() if the last chunk is incomplete

 private:
  struct Chunk;
  [[noreturn]] void refuse(std::uint64_t at, const std::string& what) const;
  void read(std::uint64_t at, void* data, std::uint64_t bytes) const;
  std::string read_text(std::uint64_t at, std::uint64_t bytes) const;
  bool next(std::uint64_t at, Chunk& chunk) const;
  void check_hash(const Chunk& chunk) const;
  void take(const Chunk& chunk);

  std::string name_, meta_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_{nullptr, &std::fclose};
  std::vector<Event> events_;
  bool ended_ = false;
  std::uint64_t bytes_ = 0, valid_bytes_ = 0;
};

/// The last stored state.
Snapshot last_keyframe(const RecordingReader& recording);

}  // namespace collidoscope
