#include "tests/fuzz/reader_checks.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "sim_cuda/changes/changes_file.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/fingerprint.h"
#include "sim_cuda/core/hash.h"
#include "sim_cuda/import/box_file.h"
#include "sim_cuda/import/npy.h"
#include "sim_cuda/import/robot_file.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/import/tree_file.h"
#include "sim_cuda/recording/recording_file.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/mesh.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "sim_cuda/stability/criterion.h"

namespace collidoscope {
namespace {

constexpr const char* file_name = "a file";

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

bool is_finite(const Vector3d& vector) { return vector.allFinite(); }

/// Few bodies, all spheres, and no other files: fast enough for fuzzing.
bool is_small(const Scene& scene) {
  const auto is_sphere = [](const Body& body) { return body.shape == Shape::sphere; };
  return bodies_of(scene) <= 100 &&
         std::ranges::all_of(scene.generators, [](const BoxCollider& g) { return g.count <= 100; }) &&
         std::ranges::all_of(scene.bodies, is_sphere) && std::ranges::all_of(scene.extra_bodies, is_sphere);
}

void check_bodies(const Scene& scene) {
  InitialBodies bodies;
  if (!is_small(scene) || !reads(scene.file, [&] { bodies = initial_bodies(scene); })) return;
  expect(static_cast<std::int64_t>(bodies.size()) == bodies_of(scene), "another number of bodies");
  for (std::size_t i = 0; i < bodies.size(); ++i)
    expect(is_finite(bodies.position[i]) && bodies.radius[i] > 0 && bodies.mass[i] > 0 &&
               std::isfinite(bodies.radius[i]) && std::isfinite(bodies.mass[i]),
           "a body that cannot be simulated");
}

/// A file in memory.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes) : file_(memfd_create("snapshot", 0)) {
    expect(file_ >= 0, "no file in memory");
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t written = ::write(file_, bytes.data() + at, bytes.size() - at);
      expect(written > 0, "a file in memory cannot be written");
      at += static_cast<std::size_t>(written);
    }
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string name() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

std::string written(const Snapshot& snapshot) {
  std::string bytes;
  write_snapshot(snapshot, [&](std::string_view more) { bytes += more; });
  return bytes;
}

void check_snapshot_file(const std::string& bytes) {
  Snapshot snapshot;
  const MemoryFile file(bytes);
  if (!reads(file.name(), [&] { snapshot = read_snapshot(file.name()); })) return;
  const std::string again = written(snapshot);
  const MemoryFile second(again);
  Snapshot same;
  expect(reads(second.name(), [&] { same = read_snapshot(second.name()); }), "what was written is refused");
  expect(written(same) == again, "a snapshot that is written otherwise when it is read again");
}

void check_recording_file(const std::string& bytes) {
  const MemoryFile file(bytes);
  std::optional<RecordingReader> recording;
  if (!reads(file.name(), [&] { recording.emplace(file.name()); })) return;
  expect(recording->valid_bytes() <= recording->bytes(), "more valid bytes than bytes");
  for (const RecordingReader::Event& event : recording->events()) {
    if (event.kind == RecordingReader::Kind::keyframe)
      reads(file.name(), [&] { recording->keyframe(event); });
    if (event.kind == RecordingReader::Kind::change)
      reads(file.name(), [&] {
        parse_changes(recording->change(event), recording->place(event),
                      parse_scene(changed_scene(), file_name), {}, event.step);
      });
  }
}

}  // namespace

bool reads(const std::string& file, const std::function<void()>& read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    expect(!error.lines().empty(), "refused without a line");
    for (const std::string& line : error.lines())
      expect(line.starts_with(file + ":") && line.find('\n') == std::string::npos,
             "not one line that begins with the file's name: " + line);
    return false;
  }
}

void check_scene(const std::string& text) {
  Scene scene;
  if (!reads(file_name, [&] { scene = parse_scene(text, file_name); })) return;
  const std::string first = write_scene(scene);
  Scene again;
  expect(reads(file_name, [&] { again = parse_scene(first, file_name); }), "what was written is refused");
  expect(write_scene(again) == first, "a scene that is written otherwise when it is read again");
  check_bodies(scene);
}

std::string changed_scene() {
  return R"({"format": "collidoscope-scene", "version": 1,
    "box": {}, "materials": {"ice": {"friction": 0.1}},
    "bodies": [{"position": [-1, 0, 0]}, {"position": [-4, 0, 0], "material": "ice"}, {"position": [-9, 0, 0]}],
    "generators": [{"kind": "box_collider", "count": 20}],
    "joints": [{"kind": "distance", "a": 0, "b": 1}]})";
}

void check_changes(const std::string& text) {
  static const Scene scene = parse_scene(changed_scene(), "the scene");
  ChangeList list;
  const auto read = [&](const std::string& from) { list = parse_changes(from, file_name, scene, {}, 0); };
  if (!reads(file_name, [&] { read(text); })) return;
  const std::string first = write_changes(list, scene);
  expect(reads(file_name, [&] { read(first); }), "what was written is refused");
  expect(write_changes(list, scene) == first, "changes that are written otherwise when they are read again");
}

void check_criterion(const std::string& text) {
  static const Scene scene = parse_scene(changed_scene(), "the scene");
  for (const Scene* sibling_path : {&scene, static_cast<const Scene*>(nullptr)}) {
    Criterion criterion;
    if (!reads(file_name, [&] { criterion = parse_criterion(text, file_name, sibling_path); })) continue;
    if (!criterion.refused.empty()) continue;
    expect(criterion.steps > 0 || !criterion.assertions.empty(), "a criterion of nothing");
    for (const InjectedFault& fault : criterion.injected_faults)
      expect(fault.assertion < criterion.assertions.size(), "a fault of a term that there is not");
  }
}

void check_snapshot(const std::string& bytes) {
  check_snapshot_file(bytes);
  constexpr std::size_t header = 40, word = 8;
  std::string mended = bytes.substr(0, bytes.size() / word * word);
  if (mended.size() < header + word) return;
  const std::uint64_t size = mended.size();
  std::memcpy(mended.data() + header - word, &size, word);
  std::uint64_t hash = 0, next = 0;
  for (std::size_t at = 0; at + word < mended.size(); at += word) {
    std::memcpy(&next, mended.data() + at, word);
    hash = mix64(hash ^ next);
  }
  std::memcpy(mended.data() + mended.size() - word, &hash, word);
  check_snapshot_file(mended);
}

void check_recording(const std::string& bytes) {
  check_recording_file(bytes);
  constexpr std::size_t file_header = 32, chunk_header = 24, word = 8;
  std::string mended = bytes;
  const auto hash_of = [&](std::size_t at, std::size_t size) {
    Fingerprint fingerprint;
    fingerprint.add(mended.data() + at, size);
    return fingerprint.value();
  };
  for (std::size_t at = file_header; at + chunk_header + word <= mended.size();) {
    const std::uint64_t check = hash_of(at, 2 * word);
    std::memcpy(mended.data() + at + 2 * word, &check, word);
    std::uint64_t size = 0;
    std::memcpy(&size, mended.data() + at + word, word);
    const std::size_t payload = at + chunk_header, rest = mended.size() - payload - word;
    if (size > rest) break;
    size = (size + word - 1) / word * word;
    if (size > rest) break;
    const std::uint64_t hash = hash_of(payload, size);
    std::memcpy(mended.data() + payload + size, &hash, word);
    at = payload + size + word;
  }
  check_recording_file(mended);
}

void check_object(const std::string& text) {
  Mesh mesh;
  if (!reads(file_name, [&] { mesh = parse_mesh(text, file_name, "mesh"); })) return;
  expect(mesh.volume > 0 && std::isfinite(mesh.volume), "a mesh without a volume");
  expect(mesh.inertia_per_density.minCoeff() > 0 && is_finite(mesh.inertia_per_density),
         "a mesh without inertia");
  expect(is_finite(mesh.center) && std::isfinite(mesh.axes.squaredNorm()), "a mesh that lies nowhere");
  expect(std::ranges::all_of(mesh.vertices, is_finite), "a vertex that lies nowhere");
  for (const auto& face : mesh.faces)
    for (const std::uint32_t vertex : face) expect(vertex < mesh.vertices.size(), "a face without a vertex");
}

void check_npy(const std::string& bytes) {
  const MemoryFile file(bytes);
  NpyArray array;
  if (!reads(file.name(), [&] { array = read_npy(file.name()); })) return;
  const std::size_t element = array.visit([](const auto* numbers) { return sizeof *numbers; });
  // The sanitizer finds an array that is shorter.
  if (array.count() > 0)
    expect(array.bytes[array.count() * element - 1] == array.bytes[array.count() * element - 1], "");
  std::vector<Aabb> boxes;
  if (!reads(file.name(), [&] { boxes = read_boxes(file.name()); })) return;
  expect(6 * boxes.size() == array.count(), "another number of boxes");
  for (const Aabb& box : boxes)
    expect(!is_empty(box) && box.min.allFinite() && box.max.allFinite(), "a box that cannot be used");
}

void check_tree(const std::string& bytes) {
  // Eight cubes in a row.
  std::vector<Aabb> boxes;
  for (int k = 0; k < 8; ++k) {
    const auto x = static_cast<float>(k);
    boxes.push_back({Vector3f(x, 0, 0), Vector3f(x + 1, 1, 1)});
  }
  const MemoryFile file(bytes);
  GivenTree tree;
  if (!reads(file.name(), [&] { tree = read_tree(file.name(), boxes); })) return;
  expect(tree.leaf_body.size() == boxes.size() && tree.parent.size() == tree.box.size(),
         "another number of leaves");
  for (std::size_t node = 0; node < tree.box.size(); ++node) {
    std::size_t above = node, steps = 0;
    while (tree.parent[above] != above && steps++ < tree.box.size()) above = tree.parent[above];
    expect(tree.parent[above] == above, "a node without a root");
    const Aabb &inside = tree.box[node], &around = tree.box[tree.parent[node]];
    expect(
        (around.min.array() <= inside.min.array()).all() && (around.max.array() >= inside.max.array()).all(),
        "a node outside of its parent");
  }
}

void check_table(const std::string& bytes) {
  const MemoryFile file(bytes);
  FileFormat format = FileFormat::unknown;
  BodyTable table;
  if (!reads(file.name(), [&] { format = format_of(file.name()); })) return;
  if (!reads(file.name(), [&] { table = read_body_table(file.name(), format, {}); })) return;
  const auto fits = [&](const auto& values) { return values.empty() || values.size() == table.size(); };
  expect(table.size() > 0 && table.frames > 0, "a table without bodies");
  expect(fits(table.radius) && fits(table.mass) && fits(table.velocity) && fits(table.angular_velocity) &&
             fits(table.orientation),
         "another number of rows");
  expect(std::ranges::all_of(table.position, is_finite), "a body that lies nowhere");
  expect(std::ranges::all_of(table.velocity, is_finite), "a speed that is not finite");
  for (const double radius : table.radius) expect(radius > 0 && std::isfinite(radius), "a bad radius");
  for (const Quaterniond& q : table.orientation)
    expect(std::abs(q.squaredNorm() - 1) < 1e-12, "an orientation of another length");
}

void check_robot(const std::string& text) {
  for (const FileFormat format : {FileFormat::urdf, FileFormat::mjcf}) {
    RobotShapes robot;
    if (!reads(file_name, [&] { robot = parse_robot(text, file_name, format); })) continue;
    expect(!robot.shapes.empty(), "a robot without shapes");
    for (const RobotShape& shape : robot.shapes)
      expect(is_finite(shape.position) && std::abs(shape.orientation.squaredNorm() - 1) < 1e-6 &&
                 std::isfinite(shape.radius) && is_finite(shape.size),
             "a shape that cannot be used");
  }
}

}  // namespace collidoscope
