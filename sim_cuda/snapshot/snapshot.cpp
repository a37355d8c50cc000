#include "sim_cuda/snapshot/snapshot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <system_error>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/fingerprint.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/scene/placed_joint.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

static_assert(std::endian::native == std::endian::little,
              "files contain values in little-endian byte order, as in memory");
static_assert(sizeof(Vector3d) == 24 && sizeof(Quaterniond) == 32 && sizeof(StaticImpulse) == 40 &&
              sizeof(ContactImpulse) == 16 && sizeof(WarmStartJoint) == 72);

constexpr std::size_t word = Fingerprint::word;
constexpr std::size_t padded(std::size_t bytes) { return (bytes + word - 1) / word * word; }

struct Header {
  char kind[24] = "collidoscope-snapshot\n";
  std::uint32_t version = snapshot_version;
  std::uint32_t byte_order = 0x01020304;
  std::uint64_t file_bytes = 0;
};
static_assert(sizeof(Header) == 40);

/// Visits the members of a snapshot in file order, for reading and writing.
template <class Archive, class SnapshotOrConst>
void visit(Archive& archive, std::string& scene, std::string& directory, SnapshotOrConst& snapshot) {
  auto& state = snapshot.state;
  archive.text(scene);
  archive.text(directory);
  archive.number(state.steps);
  archive.number(state.settings);
  archive.number(snapshot.state_hash);
  archive.number(snapshot.bodies_hash);
  visit_lists(archive, state);
  if (archive.version() >= 2) archive.list(state.frozen);
  if (archive.version() >= 3) archive.number(state.time);
  if (archive.version() >= 4) archive.number(snapshot.physics_version);
  if (archive.version() >= 5) archive.list(state.warm_start.loop_energies);
}

constexpr const char* what_writes_one = "\"collidoscope-headless run SCENE --save FILE\" writes one";

class Writer {
 public:
  explicit Writer(std::function<void(std::string_view)> write) : write_(std::move(write)) {}

  void piece(const void* data, std::size_t bytes) {
    const std::size_t whole = bytes / word * word;
    put(data, whole);
    if (whole == bytes) return;
    std::array<char, word> last{};
    std::memcpy(last.data(), static_cast<const char*>(data) + whole, bytes - whole);
    put(last.data(), word);
  }
  template <class Number>
  void number(Number value) {
    static_assert(sizeof value == word);
    piece(&value, word);
  }
  void text(const std::string& text) {
    number(static_cast<std::uint64_t>(text.size()));
    piece(text.data(), text.size());
  }
  template <class Item>
  void list(const std::vector<Item>& items) {
    number(static_cast<std::uint64_t>(items.size()));
    piece(items.data(), items.size() * sizeof(Item));
  }
  template <class Item>
  void lists(const std::vector<std::vector<Item>>& lists) {
    number(static_cast<std::uint64_t>(lists.size()));
    for (const std::vector<Item>& one : lists) list(one);
  }
  std::uint32_t version() const { return snapshot_version; }
  std::uint64_t hash() const { return fingerprint_.value(); }
  std::uint64_t bytes() const { return bytes_; }

 private:
  void put(const void* data, std::size_t bytes) {
    fingerprint_.add(data, bytes);
    bytes_ += bytes;
    if (write_ && bytes > 0) write_({static_cast<const char*>(data), bytes});
  }
  std::function<void(std::string_view)> write_;
  Fingerprint fingerprint_;
  std::uint64_t bytes_ = 0;
};

/// Opens a snapshot file. Throws InputError.
SnapshotSource open_snapshot(const std::string& file) {
  const auto refuse = [&](const std::string& what) { throw InputError(file + ": " + what); };
  std::error_code failed;
  if (std::filesystem::is_directory(file, failed)) refuse("is a folder; expected a snapshot file");
  if (std::filesystem::is_fifo(file, failed))
    refuse("is a pipe; expected a regular file, because a snapshot is read twice");
  errno = 0;
  std::FILE* const stream = std::fopen(file.c_str(), "rb");
  if (stream == nullptr)
    refuse("cannot be opened (" + std::generic_category().message(errno) + "); " + what_writes_one);
  const std::uintmax_t bytes = std::filesystem::file_size(file, failed);
  return {stream, 0, failed ? 0 : bytes, file};
}

class Reader {
 public:
  explicit Reader(const SnapshotSource& source)
      : file_(source.name), stream_(source.stream), begin_(source.begin) {
    seek(0);
    check_header(source.bytes);
    check_hash();
    left_ -= word;  // hash at the end
    seek(sizeof(Header));
  }

  [[noreturn]] void refuse(const std::string& what) const { throw InputError(file_ + ": " + what); }
  [[noreturn]] void damaged(const std::string& what) const { refuse("is damaged: " + what); }

  template <class Number>
  void number(Number& value) {
    static_assert(sizeof value == word);
    piece(&value, word);
  }
  void text(std::string& text) {
    text.resize(length(1));
    piece(text.data(), text.size());
  }
  template <class Item>
  void list(std::vector<Item>& items) {
    items.resize(length(sizeof(Item)));
    piece(items.data(), items.size() * sizeof(Item));
  }
  template <class Item>
  void lists(std::vector<std::vector<Item>>& lists) {
    lists.resize(length(word));
    for (std::vector<Item>& one : lists) list(one);
  }
  std::uint32_t version() const { return version_; }
  void end() {
    if (left_ != 0) damaged(fmt::format("{} bytes are unused", left_));
    std::uint64_t hash = 0;
    read(&hash, word);
    if (hash != fingerprint_.value()) refuse("was changed while it was read; try again");
  }

 private:
  void check_header(std::uint64_t bytes) {
    const Header expected;
    Header header;
    const std::size_t got = std::fread(&header, 1, sizeof header, stream_);
    if (got < sizeof header || std::memcmp(header.kind, expected.kind, sizeof header.kind) != 0)
      refuse(std::string("is not a snapshot; ") + what_writes_one);
    if (header.byte_order != expected.byte_order)
      refuse("has the byte order of another machine; expected little-endian");
    if (header.version < oldest_snapshot_version || header.version > expected.version)
      refuse(fmt::format("is a snapshot of version {}; this program reads versions {} to {}{}",
                         header.version, oldest_snapshot_version, expected.version,
                         header.version > expected.version ? ": use a newer version" : ": save it again"));
    version_ = header.version;
    if (bytes != header.file_bytes || bytes < sizeof header + word || bytes % word != 0)
      damaged(fmt::format("it has {} of {} bytes", bytes, header.file_bytes));
    left_ = bytes - sizeof header;
    fingerprint_.add(&header, sizeof header);
  }

  void check_hash() {
    seek(0);
    Fingerprint fingerprint;
    std::vector<char> block(1 << 16);
    for (std::uint64_t rest = left_ + sizeof(Header) - word; rest > 0;) {
      const std::size_t bytes = rest < block.size() ? static_cast<std::size_t>(rest) : block.size();
      read(block.data(), bytes);
      fingerprint.add(block.data(), bytes);
      rest -= bytes;
    }
    std::uint64_t hash = 0;
    read(&hash, word);
    if (hash != fingerprint.value()) damaged("the checksum does not match the contents");
  }

  /// Reads the length of a list with items of `item_bytes`. Fails if it exceeds the rest of the file.
  std::size_t length(std::size_t item_bytes) {
    std::uint64_t items = 0;
    number(items);
    if (items > left_ / item_bytes) damaged("a list is longer than the file");
    return static_cast<std::size_t>(items);
  }
  void piece(void* data, std::size_t bytes) {
    if (padded(bytes) > left_) damaged("it ends within a list");
    const std::size_t whole = bytes / word * word;
    read(data, whole);
    fingerprint_.add(data, whole);
    if (whole < bytes) {
      std::array<char, word> last{};
      read(last.data(), word);
      fingerprint_.add(last.data(), word);
      std::memcpy(static_cast<char*>(data) + whole, last.data(), bytes - whole);
    }
    left_ -= padded(bytes);
  }
  void read(void* data, std::size_t bytes) {
    if (bytes > 0 && std::fread(data, 1, bytes, stream_) != bytes)
      refuse("cannot be read to its end" +
             (std::ferror(stream_) ? " (" + std::generic_category().message(errno) + ")" : ""));
  }
  void seek(std::uint64_t to) {
    if (std::fseek(stream_, static_cast<long>(begin_ + to), SEEK_SET) != 0)
      refuse("cannot be read twice; expected a regular file");
  }

  std::string file_;
  std::FILE* stream_;
  std::uint64_t begin_;
  std::uint32_t version_ = 0;
  std::uint64_t left_ = 0;   ///< unread bytes, without the hash
  Fingerprint fingerprint_;  ///< hash of the bytes read so far
};

/// Checks that the lists have consistent lengths and valid ids.
bool fits(const RunState& state) {
  const std::size_t n = state.bodies.position.size();
  const WarmStart& warm_start = state.warm_start;
  const auto per = [](std::size_t size, std::size_t items) { return size == 0 || size == items; };
  bool good = state.steps >= 0 && state.bodies.velocity.size() == n &&
              state.bodies.angular_velocity.size() == n && state.bodies.orientation.size() == n &&
              per(state.static_impulses.size(), n) &&
              per(warm_start.friction.size(), warm_start.contacts.size()) &&
              per(warm_start.wall_friction.size(), warm_start.walls.size() * n) &&
              per(warm_start.rolling.size(), warm_start.contacts.size()) &&
              per(warm_start.wall_rolling.size(), warm_start.walls.size() * n) &&
              per(warm_start.sleep_timer.size(), n);
  for (const std::vector<double>& wall : warm_start.walls) good = good && wall.size() == n;
  std::uint64_t before = 0;
  for (const ContactImpulse& contact : warm_start.contacts) {
    const std::uint64_t ids = static_cast<std::uint64_t>(contact.a) << 32 | contact.b;
    good = good && contact.a < contact.b && contact.b < n && ids > before;
    before = ids;
  }
  for (std::size_t k = 0; k < state.frozen.size(); ++k)
    good = good && state.frozen[k] < n && (k == 0 || state.frozen[k - 1] < state.frozen[k]);
  for (const WarmStartJoint& joint : warm_start.joints)
    good = good && joint.a < n && (joint.b < n || joint.b == PlacedJoint::world);
  return good;
}

}  // namespace

std::uint64_t hash_of_bodies(const InitialBodies& bodies) {
  Fingerprint fingerprint;
  fingerprint.add(bodies.radius.data(), bodies.radius.size() * sizeof(double));
  fingerprint.add(bodies.mass.data(), bodies.mass.size() * sizeof(double));
  fingerprint.add(bodies.inertia.data(), bodies.inertia.size() * sizeof(Vector3d));
  return fingerprint.value();
}

void write_snapshot(const Snapshot& snapshot, const std::function<void(std::string_view)>& write) {
  std::string scene = write_scene(snapshot.scene), directory;
  const auto is_mesh = [](const Body& body) { return body.shape == Shape::mesh; };
  // Files of meshes and bodies are stored by path, not copied.
  if (!snapshot.scene.body_files.empty() || std::ranges::any_of(snapshot.scene.bodies, is_mesh))
    directory = std::filesystem::absolute(snapshot.scene.directory).string();
  Header header;
  const auto write_all = [&](Writer& writer) {
    writer.piece(&header, sizeof header);
    visit(writer, scene, directory, snapshot);
    writer.number(writer.hash());
  };
  Writer counter({});
  write_all(counter);
  header.file_bytes = counter.bytes();
  Writer writer(write);
  write_all(writer);
}

Snapshot read_snapshot(const std::string& file) {
  const SnapshotSource source = open_snapshot(file);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(source.stream, &std::fclose);
  return read_snapshot(source);
}

Snapshot read_snapshot(const SnapshotSource& source) {
  return with_allocation_context("reading a snapshot", [&] {
    Reader reader(source);
    Snapshot snapshot;
    snapshot.physics_version = first_physics_version;  // of files without the number
    std::string scene, directory;
    visit(reader, scene, directory, snapshot);
    reader.end();
    if (reader.version() < 3 && snapshot.state.steps > 0)
      snapshot.state.time = std::numeric_limits<double>::quiet_NaN();
    if (snapshot.physics_version < first_physics_version)
      reader.damaged(fmt::format("its physics version is {}", snapshot.physics_version));
    if (!fits(snapshot.state)) reader.damaged("its lists have inconsistent lengths");
    snapshot.scene = parse_scene(scene, source.name, directory.empty() ? "." : directory);
    // Recomputed, since another version may have formatted the scene's text differently.
    snapshot.state.settings = settings_hash(snapshot.scene);
    return snapshot;
  });
}

}  // namespace collidoscope
