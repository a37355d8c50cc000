#include "sim_cuda/scene/fault_lines.h"

#include <fmt/format.h>

#include <optional>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/body_reader.h"
#include "sim_cuda/scene/json_document.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

std::optional<JsonDocument> document_of(const std::string& file) {
  if (file.empty()) return std::nullopt;
  try {
    return JsonDocument(read_text_file(file, JsonDocument::max_bytes, "a scene file"), file);
  } catch (const InputError&) {  // the file is a snapshot or was deleted
    return std::nullopt;
  }
}

}  // namespace

std::vector<std::string> fault_lines(const Scene& scene, const std::vector<Fault>& faults) {
  if (faults.empty()) return {};
  const std::optional<JsonDocument> document = document_of(scene.file);
  std::vector<JsonFault> located;
  std::vector<std::string> others;
  for (const Fault& fault : faults) {
    if (document) {
      const auto [node, exact] = locate(*document, document->root(), fault.path);
      if (exact) {
        located.push_back({node->begin, line_of(fault)});
        continue;
      }
    }
    others.push_back(fmt::format("{}: {}", scene.file.empty() ? scene.name : scene.file, line_of(fault)));
  }
  std::vector<std::string> lines =
      document ? document->lines(std::move(located)) : std::vector<std::string>{};
  lines.insert(lines.end(), others.begin(), others.end());
  return lines;
}

}  // namespace collidoscope
