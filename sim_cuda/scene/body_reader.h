#pragma once
// JSON readers shared by scene files and change files: bodies, effect lists, material names and paths.
// Stateless functions. Faults are appended to the Reading.

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sim_cuda/scene/object_reader.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// The materials of a scene and an index by name. Keeps a reference to the list, which must outlive it.
struct KnownMaterials {
  const std::vector<Material>& list;
  std::unordered_map<std::string, int> numbers;

  explicit KnownMaterials(const std::vector<Material>& materials) : list(materials) { number(); }
  void number();  ///< rebuilds `numbers`; call after the list has changed
};

void read_material_name(Reading& reading, ObjectReader& reader, const KnownMaterials& materials,
                        int& material);
/// Reads the member "orientation", `[w, x, y, z]`, and normalises it.
void read_orientation(Reading& reading, ObjectReader& reader, Quaterniond& orientation);
void read_body(Reading& reading, const JsonNode& node, const KnownMaterials& materials, Body& body);
/// Reads "auto" (result: unset) or a list of effect names.
void read_effects(Reading& reading, const JsonNode& node, std::optional<Effects>& effects);

/// Resolves a path such as `bodies[3].position[0]` or `materials["a b"].density`, starting at `from`.
/// Returns the node and true. If the path leaves the document: the last node on the path that exists, and
/// false.
std::pair<const JsonNode*, bool> locate(const JsonDocument& document, const JsonNode& from,
                                        std::string_view path);

}  // namespace collidoscope
