#include "sim_cuda/recording/recording_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/fingerprint.h"
#include "sim_cuda/core/out_of_memory.h"

namespace collidoscope {
namespace {

static_assert(std::endian::native == std::endian::little,
              "files contain values in little-endian byte order, as in memory");

constexpr std::uint64_t recording_word = Fingerprint::word;

struct FileHeader {
  char kind[24] = "collidoscope-recording\n";
  std::uint32_t byte_order = 0x01020304;
  std::uint32_t version = recording_version;
};
static_assert(sizeof(FileHeader) == 32);

struct ChunkHeader {
  ChunkType type;
  std::uint32_t version = 1;
  std::uint64_t bytes = 0;  ///< of the payload, without padding
  std::uint64_t check = 0;  ///< hash of the members above
  std::uint64_t hash() const {
    Fingerprint fingerprint;
    fingerprint.add(this, 2 * recording_word);
    return fingerprint.value();
  }
};
static_assert(sizeof(ChunkHeader) == 24);

/// Length of a chunk that is being written. It is longer than any file.
constexpr std::uint64_t unfinished = ~std::uint64_t{0};

constexpr std::uint64_t padded_payload(std::uint64_t bytes) {
  return (bytes + recording_word - 1) / recording_word * recording_word;
}
std::string system_reason() { return std::generic_category().message(errno); }

/// Type as text, for messages.
std::string shown_type(const ChunkType& type) {
  std::string text(type.begin(), type.end());
  for (char& c : text)
    if (c < 0x20 || c > 0x7e) c = '?';
  return text;
}

}  // namespace

bool is_recording(const std::string& file) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) return false;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  char kind[sizeof FileHeader::kind];
  return stream && std::fread(kind, 1, sizeof kind, stream.get()) == sizeof kind &&
         std::memcmp(kind, FileHeader().kind, sizeof kind) == 0;
}

// ---- writing ----

RecordingWriter::RecordingWriter(const std::string& file) : name_(file) {
  std::error_code failed;
  if (std::filesystem::exists(file, failed) && !std::filesystem::is_regular_file(file, failed))
    throw InputError(file + ": is not a regular file, expected a file name for the recording");
  errno = 0;
  stream_.reset(std::fopen(file.c_str(), "wb"));
  if (!stream_) throw InputError(file + ": cannot be written (" + system_reason() + ")");
  begin();
}

RecordingWriter::RecordingWriter(AtomicFile& target)
    : target_(&target), stream_(target.stream(), [](std::FILE*) { return 0; }) {
  begin();
}

void RecordingWriter::begin() {
  const FileHeader header;
  put(&header, sizeof header);
  flush();
  end_ = sizeof header;
}

void RecordingWriter::write(const ChunkType& type, const std::function<void(const Sink&)>& write_payload) {
  // The length is written last, so that a chunk is complete or ends the file.
  ChunkHeader header{type, type == chunk_types::hashes ? hashes_version : 1};
  header.bytes = unfinished;
  header.check = header.hash();
  seek(end_);
  put(&header, sizeof header);
  header.bytes = 0;
  Fingerprint fingerprint;
  std::array<char, recording_word> rest{};  // of a piece that ends within a word
  write_payload([&](std::string_view piece) {
    put(piece.data(), piece.size());
    std::size_t held = header.bytes % recording_word;
    header.bytes += piece.size();
    while (!piece.empty() && (held > 0 || piece.size() < recording_word)) {
      rest[held++] = piece[0];
      piece.remove_prefix(1);
      if (held == recording_word) {
        fingerprint.add(rest.data(), recording_word);
        held = 0;
      }
    }
    const std::size_t whole = piece.size() / recording_word * recording_word;
    fingerprint.add(piece.data(), whole);
    std::copy(piece.begin() + static_cast<std::ptrdiff_t>(whole), piece.end(), rest.begin());
  });
  if (const std::size_t held = header.bytes % recording_word; held > 0) {
    std::fill(rest.begin() + static_cast<std::ptrdiff_t>(held), rest.end(), '\0');
    fingerprint.add(rest.data(), recording_word);
    put(rest.data() + held, recording_word - held);
  }
  const std::uint64_t hash = fingerprint.value();
  put(&hash, recording_word);
  flush();
  header.check = header.hash();
  seek(end_);
  put(&header, sizeof header);
  flush();
  end_ += sizeof header + padded_payload(header.bytes) + recording_word;
}

void RecordingWriter::write(const ChunkType& type, std::string_view payload) {
  write(type, [&](const Sink& sink) { sink(payload); });
}

void RecordingWriter::put(const void* data, std::size_t bytes) {
  errno = 0;
  if (std::fwrite(data, 1, bytes, stream_.get()) != bytes) fail();
}
void RecordingWriter::seek(std::uint64_t to) {
  errno = 0;
  if (std::fseek(stream_.get(), static_cast<long>(to), SEEK_SET) != 0) fail();
}
void RecordingWriter::flush() {
  errno = 0;
  if (std::fflush(stream_.get()) != 0) fail();
}
void RecordingWriter::fail() const {
  if (target_ != nullptr) target_->fail();
  throw MachineError(fmt::format("{}: cannot be written: {}; the recording is valid up to byte {}", name_,
                                 system_reason(), end_));
}

// ---- reading ----

struct RecordingReader::Chunk {
  ChunkType type;
  std::uint32_t version;
  std::uint64_t bytes;  ///< of the payload
  std::uint64_t begin;  ///< of the header
  std::uint64_t payload() const { return begin + sizeof(ChunkHeader); }
  std::uint64_t end() const { return payload() + padded_payload(bytes) + recording_word; }
};

RecordingReader::RecordingReader(const std::string& file) : name_(file) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed))
    throw InputError(file + ": is not a regular file; expected a recording");
  errno = 0;
  stream_.reset(std::fopen(file.c_str(), "rb"));
  if (!stream_) throw InputError(file + ": cannot be opened (" + system_reason() + ")");
  bytes_ = std::filesystem::file_size(file, failed);
  FileHeader header;
  const FileHeader expected;
  if (bytes_ < sizeof header) refuse(0, "the file has no complete header; expected a recording");
  read(0, &header, sizeof header);
  if (std::memcmp(header.kind, expected.kind, sizeof header.kind) != 0)
    refuse(0, "is not a recording; \"collidoscope-headless run SCENE --record FILE\" writes one");
  if (header.byte_order != expected.byte_order)
    refuse(offsetof(FileHeader, byte_order), "byte order of another machine, expected little-endian");
  if (header.version != expected.version)
    refuse(offsetof(FileHeader, version),
           fmt::format("version {} of the format, expected {}", header.version, expected.version));
  valid_bytes_ = sizeof header;
  with_allocation_context("reading a recording", [&] {
    for (Chunk chunk; next(valid_bytes_, chunk); valid_bytes_ = chunk.end()) take(chunk);
  });
  if (events_.empty()) refuse(valid_bytes_, "no complete keyframe, expected one at the start");
}

/// Reads the header of the chunk at `at`. Returns false at the end of the valid part.
bool RecordingReader::next(std::uint64_t at, Chunk& chunk) const {
  ChunkHeader header;
  if (bytes_ - at < sizeof header) return false;
  read(at, &header, sizeof header);
  if (header.check != header.hash()) refuse(at, "the header of the chunk is damaged");
  const std::uint64_t rest = bytes_ - at - sizeof header;
  if (header.bytes > rest || padded_payload(header.bytes) + recording_word > rest) return false;
  chunk = {header.type, header.version, header.bytes, at};
  check_hash(chunk);
  return true;
}

void RecordingReader::check_hash(const Chunk& chunk) const {
  Fingerprint fingerprint;
  std::vector<char> block(1 << 16);
  std::uint64_t at = chunk.payload();
  for (std::uint64_t rest = padded_payload(chunk.bytes); rest > 0;) {
    const std::uint64_t bytes = std::min<std::uint64_t>(rest, block.size());
    read(at, block.data(), bytes);
    fingerprint.add(block.data(), bytes);
    at += bytes;
    rest -= bytes;
  }
  std::uint64_t hash = 0;
  read(at, &hash, recording_word);
  if (hash != fingerprint.value())
    refuse(chunk.begin,
           fmt::format("the contents of the chunk {} do not match their hash", shown_type(chunk.type)));
}

void RecordingReader::take(const Chunk& chunk) {
  const auto require = [&](bool good, const char* what) {
    if (!good) refuse(chunk.begin, fmt::format("chunk {}: {}", shown_type(chunk.type), what));
  };
  if (chunk.type == chunk_types::meta) {
    meta_ = read_text(chunk.payload(), chunk.bytes);
    return;
  }
  Event event{};
  if (chunk.type == chunk_types::keyframe)
    event.kind = Kind::keyframe;
  else if (chunk.type == chunk_types::change)
    event.kind = Kind::change;
  else if (chunk.type == chunk_types::hashes)
    event.kind = Kind::hashes;
  else if (chunk.type != chunk_types::end)
    return;
  if (event.kind == Kind::hashes)
    require(chunk.version == 1 || chunk.version == hashes_version, "unknown version, expected 1 or 2");
  else
    require(chunk.version == 1, "unknown version, expected 1");
  event.version = chunk.version;
  require(!ended_, "follows the chunk END");
  if (chunk.type == chunk_types::end) {
    ended_ = true;
    return;
  }
  const bool is_keyframe = event.kind == Kind::keyframe;
  require(is_keyframe || !events_.empty(), "comes before the first keyframe");
  const std::uint64_t prefix = is_keyframe ? 2 * recording_word : recording_word;
  require(chunk.bytes >= prefix, "is too short");
  read(chunk.payload(), &event.step, recording_word);
  if (is_keyframe) read(chunk.payload() + recording_word, &event.full_hash, recording_word);
  require(event.step >= 0, "negative number of steps");
  event.begin = chunk.payload() + prefix;
  event.bytes = chunk.bytes - prefix;
  if (event.kind == Kind::hashes) {
    require(event.bytes % sizeof(StateHashes) == 0, "its length is not that of a list of hashes");
    event.hashes.resize(event.bytes / sizeof(StateHashes));
    read(event.begin, event.hashes.data(), event.bytes);
  }
  events_.push_back(std::move(event));
}

Snapshot RecordingReader::keyframe(const Event& event) const {
  return read_snapshot(SnapshotSource{stream_.get(), event.begin, event.bytes, place(event)});
}

std::string RecordingReader::change(const Event& event) const { return read_text(event.begin, event.bytes); }

std::string RecordingReader::place(const Event& event) const {
  return fmt::format("{}: byte {}", name_, event.begin);
}

void RecordingReader::refuse(std::uint64_t at, const std::string& what) const {
  throw InputError(fmt::format("{}: byte {}: {}", name_, at, what));
}

void RecordingReader::read(std::uint64_t at, void* data, std::uint64_t bytes) const {
  errno = 0;
  if (bytes > 0 && (std::fseek(stream_.get(), static_cast<long>(at), SEEK_SET) != 0 ||
                    std::fread(data, 1, bytes, stream_.get()) != bytes))
    refuse(at, errno != 0 ? "cannot be read (" + system_reason() + ")" : "was shortened while it was read");
}

std::string RecordingReader::read_text(std::uint64_t at, std::uint64_t bytes) const {
  std::string text(bytes, '\0');
  read(at, text.data(), bytes);
  return text;
}

Snapshot last_keyframe(const RecordingReader& recording) {
  const auto& events = recording.events();
  const auto last = std::find_if(events.rbegin(), events.rend(), [](const RecordingReader::Event& event) {
    return event.kind == RecordingReader::Kind::keyframe;
  });
  return recording.keyframe(*last);  // the first event is a keyframe
}

}  // namespace collidoscope
