#include "sim_cuda/changes/changes_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <unordered_set>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/body_reader.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/field_json.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/patch_reader.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

class ChangesReader {
 public:
  ChangesReader(const JsonDocument& document, const Scene& scene, const RunOptions& options,
                std::int64_t start)
      : document_(document),
        reading_{document, document.faults()},
        scene_(scene),
        options_(options),
        materials_(scene.materials),
        start_(start) {}

  /// Reads the document into `list` and returns all faults.
  std::vector<JsonFault> read(ChangeList& list) {
    ObjectReader root(reading_, document_.root(), "a list of changes");
    if (root.is_object()) {
      root.header("collidoscope-changes", "a list of changes");
      if (const JsonNode* changes = root.member("changes", JsonKind::array))
        for (const JsonNode& node : document_.children(*changes)) read_change(node, list.changes);
      if (const JsonNode* node = root.member("end")) read_end(*node, list);
    }
    root.finish();
    return std::move(reading_.faults);
  }

 private:
  void read_end(const JsonNode& node, ChangeList& list) {
    ObjectReader reader(reading_, node, "\"end\"");
    RecordedEnd end;
    end.physics_version = first_physics_version;  // of files without the number
    std::string hash;
    if (reader.whole("step", end.step) && end.step < start_)
      reading_.fault(
          *reader.member("step"),
          fmt::format("lies before state {}, where the run continues; must be that state or a later one",
                      start_));
    if (reader.text("state_hash", hash)) {
      const auto [stop, error] = std::from_chars(hash.data(), hash.data() + hash.size(), end.state_hash, 16);
      if (error != std::errc{} || stop != hash.data() + hash.size() || hash.size() != 16)
        reading_.fault(*reader.member("state_hash"), "\"state_hash\" must be 16 hexadecimal digits");
    }
    if (reader.whole("physics_version", end.physics_version) && end.physics_version < first_physics_version)
      reading_.fault(*reader.member("physics_version"), "\"physics_version\" must be 1 or more");
    reader.finish();
    if (reader.is_object() && (reader.member("step") == nullptr || reader.member("state_hash") == nullptr))
      reading_.fault(node, "\"end\" must have a \"step\" and its \"state_hash\"");
    list.end = end;
  }

  void read_change(const JsonNode& node, std::vector<Change>& changes) {
    Change change;
    ObjectReader reader(reading_, node, "a change");
    if (!reader.is_object()) return;
    read_step(node, reader, change);
    read_patch(reading_, reader, change.settings,
               [](const auto& setting) { return setting.live != Live::never; });
    const JsonNode* remove = reader.member("remove", JsonKind::array);
    if (remove != nullptr) read_ids(*remove, "remove", change.remove);
    const JsonNode* add = reader.member("add", JsonKind::array);
    if (add != nullptr)
      for (const JsonNode& body : document_.children(*add))
        read_body(reading_, body, materials_, change.add.emplace_back());
    const JsonNode* freeze = reader.member("freeze", JsonKind::array);
    if (freeze != nullptr) read_ids(*freeze, "freeze", change.freeze);
    reader.finish();
    if (!reading_.faults.empty()) return;  // avoid consequential faults
    if (freeze != nullptr && !can_freeze(change, *freeze)) return;
    try_change(node, change, remove);
    changes.push_back(std::move(change));
  }

  void read_step(const JsonNode& node, ObjectReader& reader, Change& change) {
    if (!reader.whole("step", change.step)) {
      if (reader.member("step") == nullptr)
        reading_.fault(node, "a change must have a \"step\", the number of the state at which it applies");
      return;
    }
    if (change.step < 0)
      reading_.fault(*reader.member("step"), "\"step\" must be the number of a state, 0 or more");
    else if (change.step < last_)
      reading_.fault(
          *reader.member("step"),
          fmt::format(
              "changes must be in ascending order of \"step\"; the change before this one has step {}",
              last_));
    else if (change.step > 0 && change.step < start_)
      reading_.fault(*reader.member("step"), fmt::format("lies before state {}, where the run continues; "
                                                         "must be that state, a later one, or 0 to restart",
                                                         start_));
    if (change.step == 0) start_ = 0;
    last_ = std::max(last_, change.step);
  }

  void read_ids(const JsonNode& list, const char* key, std::vector<std::int64_t>& ids) {
    for (const JsonNode& child : document_.children(list)) {
      const std::string_view digits = document_.token(child);
      std::int64_t id = -1;
      const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), id);
      if (child.kind != JsonKind::number || error != std::errc{} || stop != digits.data() + digits.size())
        reading_.fault(child, fmt::format("\"{}\" must be a list of ids (whole numbers)", key));
      ids.push_back(id);
    }
  }

  /// Applies a change and reports faults of the resulting scene.
  void try_change(const JsonNode& node, const Change& change, const JsonNode* remove) {
    if (!fits_generators(node, change) || !ids_exist(change, remove)) return;
    const Scene before = scene_;
    apply_change(change, scene_, options_);
    for (Fault& fault : validate(scene_)) {
      const JsonNode* at = place_of(fault.path, node, before.extra_bodies.size());
      const bool is_value = at != &node && (at->kind == JsonKind::number || at->kind == JsonKind::text);
      reading_.fault(
          *at, line_of(fault) + (is_value ? fmt::format(", not {}", printable(document_.token(*at))) : ""));
    }
    if (reading_.faults.empty() && change.step > 0 && requires_restart(before, scene_))
      reading_.fault(node,
                     "other bodies or another box need a restart: such a change must be at \"step\": 0");
    if (reading_.faults.empty() && !change.add.empty()) try_bodies(node);
  }

  bool fits_generators(const JsonNode& node, const Change& change) {
    if (!change.settings.of_generator() || scene_.generators.size() == 1) return true;
    std::string key;
    change.settings.for_each_set([&](const auto& setting, const auto&) {
      if (key.empty() && is_of_generator(setting)) key = setting.name;
    });
    reading_.fault(
        *document_.find(node, key),
        fmt::format("\"{}\" needs a scene with one generator; this one has {}", key,
                    scene_.generators.empty() ? "none" : fmt::to_string(scene_.generators.size())));
    return false;
  }

  bool ids_exist(const Change& change, const JsonNode* remove) {
    if (remove == nullptr) return true;
    Scene counted = scene_;
    Change settings = change;
    settings.remove.clear();
    settings.add.clear();
    RunOptions options = options_;
    apply_change(settings, counted, options);
    return are_ids(change.remove, *remove, bodies_of(counted));
  }

  bool are_ids(const std::vector<std::int64_t>& ids, const JsonNode& list, std::int64_t bodies) {
    std::unordered_set<std::int64_t> seen;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const JsonNode& at = document_.children(list)[k];
      if (ids[k] < 0 || ids[k] >= bodies)
        reading_.fault(at, fmt::format("body {} does not exist; ids must be below {}", ids[k], bodies));
      if (!seen.insert(ids[k]).second)
        reading_.fault(at, fmt::format("body {} appears twice in this list; list it once", ids[k]));
    }
    return reading_.faults.empty();
  }

  /// Checks that all bodies to freeze are dynamic. Generated bodies always are.
  bool can_freeze(const Change& change, const JsonNode& freeze) {
    const std::int64_t bodies = bodies_of(scene_), listed = std::ssize(scene_.bodies),
                       first_added = bodies - std::ssize(scene_.extra_bodies);
    if (!are_ids(change.freeze, freeze, bodies)) return false;
    for (std::size_t k = 0; k < change.freeze.size(); ++k) {
      const std::int64_t id = change.freeze[k];
      const Body* body = id < listed ? &scene_.bodies[static_cast<std::size_t>(id)]
                         : id < first_added
                             ? nullptr
                             : &scene_.extra_bodies[static_cast<std::size_t>(id - first_added)];
      if (body != nullptr && body->motion != Motion::dynamic)
        reading_.fault(document_.children(freeze)[k],
                       fmt::format("body {} is not dynamic; only dynamic bodies can be frozen", id));
    }
    return reading_.faults.empty();
  }

  /// Checks that need the bodies themselves: meshes, masses from densities.
  void try_bodies(const JsonNode& node) {
    if (bodies_of(scene_) > limits::max_listed)
      return;  // too many to create here; the run reports such faults
    try {
      initial_bodies(scene_);
    } catch (const InputError& error) {
      for (const std::string& line : error.lines()) reading_.fault(node, line);
    }
  }

  /// JSON node for a fault in the changed scene, or the change itself if no member matches. Converts `path`
  /// to the path within the change.
  const JsonNode* place_of(std::string& path, const JsonNode& change, std::size_t added_before) {
    const JsonNode* found = nullptr;
    for_each_setting([&]<auto member>(const Field<member>& setting) {
      std::string key(setting.name);
      if (found != nullptr || !is_physical(setting)) return;
      if (is_field<member, &Physics::time_step> && path == "steps_per_second")
        key = path;
      else if (path != path_of(setting))
        return;
      found = document_.find(change, key);
      if (found != nullptr) path = key;
    });
    if (found != nullptr) return found;
    if (const JsonNode* add = document_.find(change, "add");
        add != nullptr && path.starts_with("extra_bodies[")) {
      std::size_t index = 0;
      const char* const digits = path.data() + std::string_view("extra_bodies[").size();
      const char* const stop = std::from_chars(digits, path.data() + path.size(), index).ptr;
      if (index >= added_before && index - added_before < add->child_count && *stop == ']') {
        const JsonNode& body = document_.children(*add)[index - added_before];
        const std::string member(stop + 1);
        path = fmt::format("add[{}]{}", index - added_before, member);
        return locate(document_, body, member).first;
      }
    }
    if (const JsonNode* solver = document_.find(change, "solver"))
      return solver;  // the solver causes most of these faults
    return &change;
  }

  const JsonDocument& document_;
  Reading reading_;
  Scene scene_;  ///< after the changes so far
  RunOptions options_;
  KnownMaterials materials_;
  std::int64_t start_, last_ = 0;
};

std::string text_of(const Change& change, const Scene& scene) {
  ObjectText object;
  object("step", scalar_text(change.step));
  change.settings.for_each_set([&]<auto member>(const Field<member>& setting, const auto& value) {
    if constexpr (is_field<member, &RunOptions::broad_phase>)
      if (is_plugin(value)) return;  // files do not load code, and the method does not change the state
    put(object, setting.name, setting, value);
  });
  if (!change.remove.empty()) object("remove", list_text(change.remove));
  std::vector<std::string> bodies;
  for (const Body& body : change.add) bodies.push_back(write_body(body, scene));
  if (!bodies.empty()) object("add", list_text(bodies));
  if (!change.freeze.empty()) object("freeze", list_text(change.freeze));
  return object.text();
}

}  // namespace

ChangeList parse_changes(std::string text, const std::string& name, const Scene& scene,
                         const RunOptions& options, std::int64_t start) {
  return with_allocation_context("reading a list of changes", [&] {
    JsonDocument document(std::move(text), name);
    ChangeList list;
    document.read_all([&](bool first) {
      ChangeList other;
      return ChangesReader(document, scene, options, start).read(first ? list : other);
    });
    return list;
  });
}

ChangeList read_changes(const std::string& file, const Scene& scene, const RunOptions& options,
                        std::int64_t start) {
  return parse_changes(read_text_file(file, JsonDocument::max_bytes, "a list of changes (.json)"), file,
                       scene, options, start);
}

std::string write_changes(const ChangeList& list, const Scene& scene) {
  std::string text = "{\n  \"format\": \"collidoscope-changes\",\n  \"version\": 1,\n  \"changes\": [";
  for (std::size_t k = 0; k < list.changes.size(); ++k)
    text += (k > 0 ? ",\n    " : "\n    ") + text_of(list.changes[k], scene);
  text += list.changes.empty() ? "]" : "\n  ]";
  if (list.end)
    text +=
        fmt::format(",\n  \"end\": {{\"step\": {}, \"state_hash\": \"{:016x}\", \"physics_version\": {}}}",
                    list.end->step, list.end->state_hash, list.end->physics_version);
  return text + "\n}\n";
}

}  // namespace collidoscope
