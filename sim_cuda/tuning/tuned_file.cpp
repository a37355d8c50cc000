#include "sim_cuda/tuning/tuned_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/object_reader.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

constexpr const char* tuned_format = "collidoscope-tuned";
constexpr std::size_t most_tuned_bytes = 16 << 20;

class TunedReader {
 public:
  explicit TunedReader(Reading& reading) : reading_(reading), document_(reading.document) {}

  std::vector<TunedShapes> read() {
    std::vector<TunedShapes> results;
    ObjectReader root(reading_, document_.root(), "a file of tuned shapes");
    root.header(tuned_format, "a file of tuned shapes");
    if (const JsonNode* list = root.member("results", JsonKind::array))
      for (const JsonNode& node : document_.children(*list)) results.push_back(result_of(node));
    root.finish();
    return results;
  }

 private:
  TunedShapes result_of(const JsonNode& node) {
    TunedShapes result;
    TuningConditions& conditions = result.conditions;
    ObjectReader object(reading_, node, "a result");
    for (const auto& [key, value] : {std::pair{"device", &conditions.device},
                                     {"driver", &conditions.driver},
                                     {"build", &conditions.build},
                                     {"broad_phase", &conditions.broad_phase},
                                     {"solver", &conditions.solver},
                                     {"precision", &conditions.precision},
                                     {"scene", &conditions.scene},
                                     {"data", &result.data}})
      object.text(key, *value);
    for (const char* key : {"device", "build", "broad_phase", "solver", "precision", "bodies", "ratio"})
      if (object.is_object() && object.member(key) == nullptr)
        reading_.fault(node, fmt::format("\"{}\" is missing", key));
    object.whole("cpu_threads", conditions.cpu_threads);
    object.whole("bodies", conditions.bodies);
    if (const JsonNode* list = object.member("effects", JsonKind::array))
      for (const JsonNode& name : document_.children(*list)) {
        if (name.kind == JsonKind::text)
          conditions.effects.emplace_back(document_.text(name));
        else
          reading_.fault(name, "must be the name of an effect");
      }
    read_shape(object, "shape", result.shape);
    if (const JsonNode* stages = object.member("stages", JsonKind::object)) {
      ObjectReader by_stage(reading_, *stages, "the shapes of stages");
      for (const JsonNode& stage : document_.children(*stages)) {
        LaunchShape shape;
        read_shape(by_stage, document_.key(stage), shape);
        result.stages.push_back({std::string(document_.key(stage)), shape});
      }
    }
    if (const JsonNode* ratio = object.member("ratio", JsonKind::object)) {
      ObjectReader estimate(reading_, *ratio, "a ratio");
      RatioEstimate& r = result.ratio;
      estimate.real("median", r.ratio);
      estimate.real("low", r.low);
      estimate.real("high", r.high);
      estimate.whole("pairs", r.pairs);
      estimate.finish();
      if (!(0 < r.low && r.low <= r.ratio && r.ratio <= r.high))
        reading_.fault(*ratio, "must have 0 < low <= median <= high");
    }
    object.finish();
    return result;
  }

  void read_shape(ObjectReader& object, std::string_view key, LaunchShape& shape) {
    double values[2] = {};
    const JsonNode* node = object.numbers(key, values, 2, "two numbers, [B, T]");
    if (node == nullptr) return;
    const auto is_whole = [](double value, double most) {
      return value >= 0 && value <= most && value == static_cast<double>(static_cast<std::int64_t>(value));
    };
    if (!is_whole(values[0], limits::max_blocks) || !is_whole(values[1], limits::max_threads))
      return reading_.fault(
          *node, fmt::format("\"{}\" must be 0 (auto) to {} blocks and 0 (auto) to {} threads", key,
                             limits::max_blocks, limits::max_threads));
    shape = {static_cast<int>(values[0]), static_cast<int>(values[1])};
  }

  Reading& reading_;
  const JsonDocument& document_;
};

nlohmann::ordered_json json_of(LaunchShape shape) { return {shape.blocks, shape.threads}; }

nlohmann::ordered_json json_of(const TunedShapes& result) {
  using Json = nlohmann::ordered_json;
  const TuningConditions& c = result.conditions;
  Json json{{"device", c.device},
            {"driver", c.driver},
            {"build", c.build},
            {"cpu_threads", c.cpu_threads},
            {"broad_phase", c.broad_phase},
            {"solver", c.solver},
            {"precision", c.precision},
            {"effects", c.effects},
            {"bodies", c.bodies},
            {"scene", c.scene}};
  if (!result.data.empty()) json["data"] = result.data;
  json["ratio"] = {{"median", result.ratio.ratio},
                   {"low", result.ratio.low},
                   {"high", result.ratio.high},
                   {"pairs", result.ratio.pairs}};
  json["shape"] = json_of(result.shape);
  json["stages"] = Json::object();
  for (const StageShape& stage : result.stages) json["stages"][stage.stage] = json_of(stage.shape);
  return json;
}

}  // namespace

std::vector<TunedShapes> read_tuned(const std::string& file) {
  JsonDocument document(read_text_file(file, most_tuned_bytes, "a file of tuned shapes (.json)"), file);
  std::vector<TunedShapes> results;
  document.read_all([&](bool first) {
    Reading reading{document, {}};
    std::vector<TunedShapes> read = TunedReader(reading).read();
    if (first) results = std::move(read);
    return reading.faults;
  });
  return results;
}

std::string write_tuned(const std::vector<TunedShapes>& results) {
  std::string text =
      fmt::format("{{\n  \"format\": \"{}\",\n  \"version\": 1,\n  \"results\": [", tuned_format);
  for (const TunedShapes& result : results)  // a line each
    text += (&result == results.data() ? "\n    " : ",\n    ") +
            json_of(result).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  return text + "\n  ]\n}\n";
}

std::string tuned_cache() {
  const std::filesystem::path folder = cache_folder();
  return folder.empty() ? "" : (folder / "tuned.json").string();
}

std::vector<TunedShapes> known_tuned(std::vector<std::string>& warnings) {
  std::vector<TunedShapes> known;
  const auto add = [&](const std::filesystem::path& file) {
    std::error_code failed;
    if (file.empty() || !std::filesystem::exists(file, failed)) return false;
    try {
      std::ranges::move(read_tuned(file.string()), std::back_inserter(known));
    } catch (const InputError& error) {
      warnings.emplace_back(error.what());
    }
    return true;
  };
  add(tuned_cache());
  const std::vector<std::filesystem::path> folders = asset_folders();
  static_cast<void>(std::ranges::any_of(
      folders, [&](const std::filesystem::path& folder) { return add(folder / "tuned.json"); }));
  return known;
}

std::string with_tuned(const std::string& file, const TunedShapes& result) {
  std::error_code failed;
  std::vector<TunedShapes> results;
  if (std::filesystem::exists(file, failed)) results = read_tuned(file);
  std::erase_if(results, [&](const TunedShapes& other) { return other.conditions == result.conditions; });
  results.push_back(result);
  return write_tuned(results);
}

}  // namespace collidoscope
