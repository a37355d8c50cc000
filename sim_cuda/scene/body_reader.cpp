#include "sim_cuda/scene/body_reader.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "sim_cuda/scene/field_reader.h"
#include "sim_cuda/scene/scene_fields.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {

bool detail::read_time_step(Reading& reading, ObjectReader& reader, TimeStep& value) {
  const JsonNode *seconds = reader.member("time_step"), *rate = reader.member("steps_per_second");
  if (seconds != nullptr && rate != nullptr)
    reading.fault_at_key(seconds->begin > rate->begin ? *seconds : *rate,
                         "time_step and steps_per_second are both given; keep one of them");
  if (int n = 0; reader.whole("steps_per_second", n)) {
    value = TimeStep::per_second(n);
    return true;
  }
  double read = 0;
  if (!reader.real("time_step", read)) return false;
  value = read;
  return true;
}

namespace {

const JsonNode* member_of(const JsonDocument& document, const JsonNode& node, std::string_view key) {
  return node.kind == JsonKind::object ? document.find(node, key) : nullptr;
}

}  // namespace

void KnownMaterials::number() {
  numbers.clear();
  for (std::size_t i = 0; i < list.size(); ++i) numbers.emplace(list[i].name, static_cast<int>(i));
}

void read_material_name(Reading& reading, ObjectReader& reader, const KnownMaterials& materials,
                        int& material) {
  const JsonNode* node = reader.member("material", JsonKind::text);
  if (node == nullptr) return;
  const std::string name(reading.document.text(*node));
  if (name == "default") {
    material = 0;
  } else if (const auto entry = materials.numbers.find(name); entry != materials.numbers.end()) {
    material = entry->second;
  } else {
    std::vector<std::string_view> names;
    for (const Material& known : materials.list) names.push_back(known.name);
    reading.fault(*node, unknown_name("material", name, names));
  }
}

void read_orientation(Reading& reading, ObjectReader& reader, Quaterniond& orientation) {
  double q[4];
  const JsonNode* node = reader.numbers("orientation", q, 4, "four numbers, the quaternion [w, x, y, z]");
  if (node == nullptr) return;
  double largest = 0;
  for (const double part : q) largest = std::max(largest, std::abs(part));
  if (!(largest > 0)) return reading.fault(*node, "the quaternion [w, x, y, z] must not be zero");
  orientation = Quaterniond(q[0], q[1], q[2], q[3]);
  if (is_unit(orientation.squaredNorm()))
    return;                         // unchanged, so that writing and reading again keeps every
                                    // bit
  orientation.coeffs() /= largest;  // avoids overflow and underflow of the squares
  orientation.coeffs() /= std::sqrt(orientation.squaredNorm());
}

void read_body(Reading& reading, const JsonNode& node, const KnownMaterials& materials, Body& body) {
  ObjectReader reader(reading, node, "a body");
  read_fields(reading, reader, body_fields, body);
  const JsonNode* radius = reader.member("radius");
  if (body.shape == Shape::mesh && radius != nullptr)
    reading.fault_at_key(*radius, "a mesh has no radius; give \"shape\": \"sphere\" or remove it");
  const JsonNode* mesh = reader.member("mesh");
  if (body.shape == Shape::sphere && mesh != nullptr)
    reading.fault_at_key(*mesh, "a sphere has no mesh; give \"shape\": \"mesh\" or remove it");
  read_material_name(reading, reader, materials, body.material);
  reader.finish();
}

void read_effects(Reading& reading, const JsonNode& node, std::optional<Effects>& effects) {
  const JsonDocument& document = reading.document;
  if (node.kind == JsonKind::text && document.text(node) == "auto") return;
  if (node.kind != JsonKind::array) {
    return reading.fault(node, "\"effects\" must be \"auto\" or a list of effects, such as [\"gravity\"]");
  }
  effects.emplace();
  const std::vector<std::string_view> names = names_in(effect_names);
  for (const JsonNode& child : document.children(node)) {
    const std::string_view name = child.kind == JsonKind::text ? document.text(child) : document.token(child);
    bool found = false;
    for (const EffectName& effect : effect_names) {
      if (child.kind != JsonKind::text || effect.name != name) continue;
      if ((*effects).*effect.flag)
        reading.fault(child, fmt::format("\"{}\" appears twice in this list; list it once", name));
      (*effects).*effect.flag = true;
      found = true;
    }
    if (!found) reading.fault(child, unknown_name("effect", name, names));
  }
}

std::pair<const JsonNode*, bool> locate(const JsonDocument& document, const JsonNode& from,
                                        std::string_view path) {
  const JsonNode* node = &from;
  while (!path.empty()) {
    const JsonNode* next = nullptr;
    if (path.starts_with("[\"")) {
      const std::size_t end = std::min(path.find("\"]"), path.size() - 2);
      next = member_of(document, *node, path.substr(2, end - 2));
      path.remove_prefix(end + 2);
    } else if (path.starts_with('[')) {
      const std::size_t end = std::min(path.find(']'), path.size() - 1);
      std::size_t index = 0;
      std::from_chars(path.data() + 1, path.data() + end, index);
      if (node->kind == JsonKind::array && index < node->child_count) next = &document.children(*node)[index];
      path.remove_prefix(end + 1);
    } else {
      if (path.starts_with('.')) path.remove_prefix(1);
      const std::size_t end = std::min(path.find_first_of(".["), path.size());
      next = member_of(document, *node, path.substr(0, end));
      path.remove_prefix(end);
    }
    if (next == nullptr) return {node, false};
    node = next;
  }
  return {node, true};
}

}  // namespace collidoscope
