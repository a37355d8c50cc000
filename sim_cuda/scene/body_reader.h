#pragma once
// What scene files and files of changes have in common: a body as an object of JSON, a list of effects, the
// name of a material. Free functions; faults go to the Reading.

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sim_cuda/scene/object_reader.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// The materials of a scene, and the place of each by its name.
struct KnownMaterials {
  const std::vector<Material>& list;
  std::unordered_map<std::string, int> numbers;

  explicit KnownMaterials(const std::vector<Material>& materials) : list(materials) { number(); }
  void number();  ///< after the list has changed
};

void read_material_name(Reading& reading, ObjectReader& reader, const KnownMaterials& materials,
                        int& material);
/// `[w, x, y, z]`, made one of length 1.
void read_orientation(Reading& reading, ObjectReader& reader, Quaterniond& orientation);
void read_body(Reading& reading, const JsonNode& node, const KnownMaterials& materials, Body& body);
/// "auto", which is nothing, or a list of names.
void read_effects(Reading& reading, const JsonNode& node, std::optional<Effects>& effects);

/// The node of a path from `node` such as `bodies[3].position[0]` or `materials["a b"].density`, or the
/// innermost one on the way to it that there is, and false.
std::pair<const JsonNode*, bool> locate(const JsonDocument& document, const JsonNode& from,
                                        std::string_view path);

}  // namespace collidoscope
