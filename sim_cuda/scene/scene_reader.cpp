// Converts scene files to structs. Types, keys and names are checked here. validate() checks ranges; its
// paths are then located in the text, so one set of range checks covers files and structs.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/scene/body_file.h"
#include "sim_cuda/scene/body_reader.h"
#include "sim_cuda/scene/derived_faults.h"
#include "sim_cuda/scene/field_reader.h"
#include "sim_cuda/scene/json_document.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/object_reader.h"
#include "sim_cuda/scene/scene_fields.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/settings.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_body_files = 1000;
constexpr JsonAlias scene_aliases[] = {
    {"angular_speed", "spin"}, {"excluded", "without"}, {"extra_bodies", "added"}};

class SceneReader {
 public:
  /// `with_meshes`: also report faults of mesh files if there are other faults. Otherwise initial_bodies()
  /// reports them.
  SceneReader(const JsonDocument& document, Scene& scene, bool with_meshes)
      : with_meshes_(with_meshes),
        document_(document),
        reading_{document, document.faults()},
        scene_(scene),
        materials_(scene.materials) {}

  /// Reads the scene and returns all faults.
  std::vector<JsonFault> read() {
    ObjectReader root(reading_, document_.root(), "a scene");
    if (root.is_object()) {
      root.header("collidoscope-scene", "a scene");
      root.text("name", scene_.name);
      if (const JsonNode* node = root.member("box"))
        read_object(*node, "a box", box_fields, scene_.box.emplace());
      read_physics(root);
      if (const JsonNode* node = root.member("materials")) read_materials(*node);
      read_bodies(root, "bodies", scene_.bodies);
      read_list(root, "generators", [&](const JsonNode& node) { read_generator(node); });
      read_list(root, "body_files", [&](const JsonNode& node) { read_file_of_bodies(node); });
      read_bodies(root, "extra_bodies", scene_.extra_bodies);
      read_list(root, "obstacles", [&](const JsonNode& node) { read_obstacle(node); });
      read_list(root, "joints", [&](const JsonNode& node) { read_joint(node); });
      if (const JsonNode* node = root.member("camera"))
        read_object(*node, "a camera", camera_fields, scene_.camera);
    }
    root.finish();
    locate_faults();
    return std::move(reading_.faults);
  }

 private:
  template <class Table, class Owner>
  void read_object(const JsonNode& node, std::string_view what, const Table& table, Owner& owner) {
    ObjectReader reader(reading_, node, what);
    read_fields(reading_, reader, table, owner);
    reader.finish();
  }

  void read_physics(ObjectReader& root) {
    Physics& physics = scene_.physics;
    read_fields(reading_, root, physics_settings, physics);
    if (const JsonNode* node = root.member("drag")) read_object(*node, "drag", drag_fields, physics.drag);
    read_list(root, "attractors", [&](const JsonNode& node) {
      read_object(node, "an attractor", attractor_fields, physics.attractors.emplace_back());
    });
    if (const JsonNode* node = root.member("sleep"))
      read_object(*node, "\"sleep\"", sleep_fields, physics.sleep.emplace());
    if (const JsonNode* node = root.member("guards"))
      read_object(*node, "\"guards\"", guards_fields, physics.guards.emplace());
  }

  void read_materials(const JsonNode& node) {
    if (node.kind != JsonKind::object) {
      return reading_.fault(
          node, fmt::format("\"materials\" must be an object of names, {{\"default\": {{ ... }}}}, not {}",
                            described(node.kind)));
    }
    if (node.child_count > limits::max_materials)
      return reading_.fault(
          node, fmt::format("{} materials; the maximum is {}", node.child_count, limits::max_materials));
    for (const JsonNode& child : document_.children(node)) {
      const std::string_view name = document_.key(child);
      Material& material =
          name == "default" ? scene_.materials.front() : scene_.materials.emplace_back(Material{});
      material.name = name;
      read_object(child, "a material", material_settings, material);
    }
    materials_.number();
  }

  template <class Read>
  void read_list(ObjectReader& root, std::string_view key, Read read) {
    const JsonNode* list = root.member(key, JsonKind::array);
    if (list == nullptr) return;
    // The limit bounds memory: an entry "{}" of two bytes becomes hundreds of bytes.
    if (list->child_count > limits::max_listed)
      return reading_.fault(
          *list, fmt::format("\"{}\" has {} entries; the maximum is {}; use a generator for more bodies", key,
                             list->child_count, limits::max_listed));
    for (const JsonNode& child : document_.children(*list)) read(child);
  }

  void read_bodies(ObjectReader& root, std::string_view key, std::vector<Body>& bodies) {
    read_list(root, key,
              [&](const JsonNode& node) { read_body(reading_, node, materials_, bodies.emplace_back()); });
  }

  void read_generator(const JsonNode& node) {
    BoxCollider& generator = scene_.generators.emplace_back();
    ObjectReader reader(reading_, node, "a generator");
    const JsonNode* kind = reader.member("kind");
    if (reader.is_object() &&
        (kind == nullptr || kind->kind != JsonKind::text || document_.text(*kind) != "box_collider")) {
      reading_.fault(kind == nullptr ? node : *kind, "a generator must have \"kind\": \"box_collider\"");
    }
    read_fields(reading_, reader, generator_settings, generator);
    read_material_name(reading_, reader, materials_, generator.material);
    read_excluded(reader, generator.excluded);
    reader.finish();
  }

  void read_excluded(ObjectReader& reader, std::vector<std::int64_t>& excluded) {
    const JsonNode* const list = reader.member("excluded", JsonKind::array);
    if (list == nullptr) return;
    for (const JsonNode& number : document_.children(*list)) {
      const std::optional<double> value =
          number.kind == JsonKind::number ? document_.number(number) : std::nullopt;
      if (value && *value == std::floor(*value) && std::abs(*value) < 0x1p53)
        excluded.push_back(static_cast<std::int64_t>(*value));
      else
        reading_.fault(number, "\"excluded\" must be a list of whole numbers");
    }
  }

  void read_file_of_bodies(const JsonNode& node) {
    BodyFile& file = scene_.body_files.emplace_back();
    ObjectReader reader(reading_, node, "a file of bodies");
    const std::size_t known_faults = reading_.faults.size();
    read_fields(reading_, reader, body_file_fields, file);
    read_material_name(reading_, reader, materials_, file.material);
    read_excluded(reader, file.excluded);
    const JsonNode* const path = reader.member("path");
    if (reader.is_object() && path == nullptr) reading_.fault(node, "a file of bodies must have a \"path\"");
    reader.finish();
    // validate() reports values out of range.
    const bool in_range = file.frame >= 0 && file.scale > 0 && std::isfinite(file.scale);
    if (path == nullptr || !in_range || reading_.faults.size() > known_faults ||
        scene_.body_files.size() > most_body_files)
      return;
    try {
      read_body_file(scene_.directory, file);
    } catch (const InputError& error) {
      for (const std::string& line : error.lines()) reading_.fault(*path, line);
    }
  }

  void read_obstacle(const JsonNode& node) {
    ObjectReader reader(reading_, node, "an obstacle");
    const JsonNode* shape = reader.member("shape");
    const std::string_view name =
        shape != nullptr && shape->kind == JsonKind::text ? document_.text(*shape) : "";
    if (reader.is_object() && name != "plane" && name != "box")
      reading_.fault(shape == nullptr ? node : *shape,
                     "an obstacle must have \"shape\": \"plane\" or \"shape\": \"box\"");
    if (name == "box") {
      BoxObstacle& box = scene_.boxes.emplace_back();
      box_places_.push_back(obstacle_count_++);
      read_fields(reading_, reader, box_obstacle_fields, box);
      read_material_name(reading_, reader, materials_, box.material);
    } else {
      Plane& plane = scene_.obstacles.emplace_back();
      plane_places_.push_back(obstacle_count_++);
      read_direction(reader, "normal", plane.normal);
      reader.real("offset", plane.offset);
      read_material_name(reading_, reader, materials_, plane.material);
    }
    reader.finish();
  }

  void read_joint(const JsonNode& node) {
    Joint& joint = scene_.joints.emplace_back();
    ObjectReader reader(reading_, node, "a joint");
    if (!reader.choice("kind", joint_kind_names, joint.kind) && reader.is_object() &&
        document_.find(node, "kind") == nullptr)
      reading_.fault(node, "a joint must have a \"kind\": distance, spring, ball or hinge");
    if (!reader.whole("a", joint.a) && reader.is_object() && document_.find(node, "a") == nullptr)
      reading_.fault(node, "a joint's \"a\" must be the id of a body");
    const JsonNode* b = reader.member("b");
    if (std::int64_t id = 0; b != nullptr && b->kind == JsonKind::number && reader.whole("b", id))
      joint.b = id;
    else if (b == nullptr ||
             (b->kind != JsonKind::number && (b->kind != JsonKind::text || document_.text(*b) != "world")))
      reading_.fault(b == nullptr ? node : *b, "a joint's \"b\" must be the id of a body or \"world\"");
    reader.vector("anchor_a", joint.anchor_a);
    Vector3d place(0, 0, 0);
    if (reader.vector("anchor_b", place)) joint.anchor_b = place;
    const auto number = [&](std::string_view key, bool has, std::string_view whose, auto& value) {
      if (double read = 0; has && reader.real(key, read)) value = read;
      if (const JsonNode* stray = has ? nullptr : reader.member(key))
        reading_.fault_at_key(*stray, fmt::format("\"{}\" is valid only for {}", key, whose));
    };
    const bool spring = joint.kind == JointKind::spring, distance = joint.kind == JointKind::distance;
    number("length", distance || spring, "distances and springs", joint.length);
    number("min_length", distance, "distances", joint.min_length);
    number("max_length", distance, "distances", joint.max_length);
    number("frequency", spring, "springs", joint.frequency);
    number("damping_ratio", spring, "springs", joint.damping_ratio);
    if (joint.kind == JointKind::hinge)
      read_hinge(reader, joint);
    else
      for (const char* key : {"axis", "limits"})
        if (const JsonNode* stray = reader.member(key))
          reading_.fault_at_key(*stray, fmt::format("\"{}\" is valid only for hinges", key));
    reader.truth("collide", joint.collide);
    reader.finish();
  }

  void read_hinge(ObjectReader& reader, Joint& joint) {
    read_direction(reader, "axis", joint.axis);
    double ends[2];
    if (reader.numbers("limits", ends, 2, "two angles in degrees, [min, max]") != nullptr)
      joint.limits = {ends[0], ends[1]};
  }

  /// Reads a nonzero vector and normalises it.
  void read_direction(ObjectReader& reader, std::string_view key, Vector3d& direction) {
    Vector3d vector = direction;
    if (!reader.vector(key, vector)) return;
    const double largest = vector.cwiseAbs().maxCoeff();
    if (!(largest > 0))
      return reading_.fault(*reader.member(key), fmt::format("the {} must not be zero", key));
    direction = vector;
    if (is_unit(vector.squaredNorm()))
      return;              // unchanged, so that writing and reading again keeps every
                           // bit
    direction /= largest;  // avoids overflow and underflow of the squares
    direction /= std::sqrt(direction.squaredNorm());
  }

  /// Adds the faults of validate() at their text positions. If a value is not in the text, the fault is
  /// placed at its container.
  void locate_faults() {
    for (Fault& fault : validate(scene_)) {
      fault.path = path_in_file(fault.path);
      const auto [node, exact] = locate(document_, document_.root(), fault.path);
      std::string message = line_of(fault);
      const bool is_plain = node->kind == JsonKind::number || node->kind == JsonKind::text;
      if (exact && is_plain) message += fmt::format(", not {}", printable(document_.token(*node)));
      reading_.fault(*node, std::move(message));
    }
    if (!with_meshes_ || reading_.faults.empty()) return;
    for (const Fault& fault : mesh_faults(scene_))
      reading_.fault(*locate(document_, document_.root(), fault.path).first, line_of(fault));
  }

  /// Converts a struct path to a file path. Planes and boxes have separate lists in the struct and share one
  /// list in the file.
  std::string path_in_file(const std::string& path) const {
    for (const auto& [list, places] : {std::pair("obstacles[", &plane_places_), {"boxes[", &box_places_}}) {
      if (!path.starts_with(list)) continue;
      const std::size_t begin = std::string_view(list).size(), end = path.find(']');
      const std::size_t index = std::stoul(path.substr(begin, end - begin));
      return fmt::format("obstacles[{}", places->at(index)) + path.substr(end);
    }
    return path;
  }

  bool with_meshes_;
  const JsonDocument& document_;
  Reading reading_;
  Scene& scene_;
  KnownMaterials materials_;
  std::vector<int> plane_places_, box_places_;  ///< indices in the file's list of obstacles
  int obstacle_count_ = 0;
};

}  // namespace

namespace {

Scene scene_of(std::string text, const std::string& name, const std::string& directory, bool with_meshes) {
  return with_allocation_context("reading a scene", [&] {
    Scene scene;
    scene.directory = directory;
    scene.file = name;
    JsonDocument document(std::move(text), name, scene_aliases);
    document.read_all([&](bool first) {
      Scene other;
      return SceneReader(document, first ? scene : other, with_meshes).read();
    });
    scene.warnings = document.warnings();
    return scene;
  });
}

}  // namespace

Scene parse_scene(std::string text, const std::string& name, const std::string& directory) {
  return scene_of(std::move(text), name, directory, false);
}

Scene read_scene(const std::string& file) {
  std::string text = read_text_file(file, JsonDocument::max_bytes, "a scene file (.json)");
  const std::string directory = std::filesystem::path(file).parent_path().string();
  return scene_of(std::move(text), file, directory.empty() ? "." : directory, true);
}

}  // namespace collidoscope
