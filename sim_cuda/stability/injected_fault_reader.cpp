#include "sim_cuda/stability/injected_fault_reader.h"

#include <limits>

#include "sim_cuda/scene/patch_reader.h"

namespace collidoscope {
namespace {

class InjectedFaultReader {
 public:
  explicit InjectedFaultReader(CriterionContext& context)
      : context_(context),
        document_(context.document),
        reading_(context.reading),
        criterion_(context.criterion) {}

  void read_state(const JsonNode& node) {
    ObjectReader reader(reading_, node, "\"inject\"");
    InjectedFault injected;
    if (reader.is_object()) read_injected(reader, node, injected);
    reader.finish();
    criterion_.injected_state = injected.state;
  }

  void read_fault(const JsonNode& node) {
    InjectedFault fault;
    ObjectReader reader(reading_, node, "a fault");
    if (!reader.is_object()) return;
    fault.assertion = context_.read_term(reader, node, "fails", "a fault").value_or(0);
    const JsonNode* set = reader.member("set");
    if (set != nullptr) {
      read_set(*set, fault);
    } else if (reader.text("scene", fault.scene)) {
      context_.check_file(*reader.member("scene"));
    } else if (reader.member("scene") == nullptr) {
      read_injected(reader, node, fault);
    }
    reader.finish();
    criterion_.injected_faults.push_back(std::move(fault));
  }

 private:
  void read_set(const JsonNode& node, InjectedFault& fault) {
    ObjectReader reader(reading_, node, "\"set\"");
    SettingsPatch& set = fault.set.emplace();
    read_patch(reading_, reader, set, [](const auto& setting) { return is_physical(setting); });
    reader.finish();
    if (set.of_generator() && context_.scene != nullptr && context_.scene->generators.size() != 1)
      reading_.fault(node, "settings of a generator need a scene with one generator");
  }

  void read_injected(ObjectReader& reader, const JsonNode& node, InjectedFault& fault) {
    InjectedState& injected = fault.state.emplace();
    std::optional<std::int64_t> step;
    context_.read_state(reader, "step", step);
    injected.step = step.value_or(0);
    if ((!context_.read_id(reader, injected.body) && reader.member("body") == nullptr) ||
        reader.member("step") == nullptr)
      reading_.fault(node,
                     "a fault must have a \"set\" of settings, another \"scene\", or a \"step\" and a "
                     "\"body\" with a \"position\", \"velocity\", \"angular_velocity\" or \"orientation\"");
    double q[4];
    const auto vector = [&](std::string_view key, std::optional<Vector3d>& value) {
      double parts[3];
      if (read_parts(reader, key, parts, 3)) value = Vector3d(parts[0], parts[1], parts[2]);
    };
    vector("position", injected.position);
    vector("velocity", injected.velocity);
    vector("angular_velocity", injected.angular_velocity);
    if (read_parts(reader, "orientation", q, 4)) injected.orientation = Quaterniond(q[0], q[1], q[2], q[3]);
  }

  /// Reads numbers; null stands for NaN, "inf" and "-inf" for infinities.
  bool read_parts(ObjectReader& reader, std::string_view key, double* parts, std::size_t count) {
    const JsonNode* node = reader.member(key);
    if (node == nullptr) return false;
    const auto children = document_.children(*node);
    bool good = node->kind == JsonKind::array && children.size() == count;
    for (std::size_t k = 0; good && k < count; ++k) {
      const JsonNode& child = children[k];
      if (child.kind == JsonKind::invalid) return false;  // already has a fault
      const std::string_view word = child.kind == JsonKind::text ? document_.text(child) : "";
      const std::optional<double> number =
          child.kind == JsonKind::number ? document_.number(child)
          : child.kind == JsonKind::null ? std::optional(std::numeric_limits<double>::quiet_NaN())
          : word == "inf"                ? std::optional(std::numeric_limits<double>::infinity())
          : word == "-inf"               ? std::optional(-std::numeric_limits<double>::infinity())
                                         : std::nullopt;
      good = number.has_value();
      if (good) parts[k] = *number;
    }
    if (!good)
      reading_.fault(
          *node, fmt::format("\"{}\" must be a list of {} numbers; null means NaN, \"inf\" means infinity",
                             key, count));
    return good;
  }

  CriterionContext& context_;
  const JsonDocument& document_;
  Reading& reading_;
  Criterion& criterion_;
};

}  // namespace

void read_injected_state(CriterionContext& context, const JsonNode& node) {
  InjectedFaultReader(context).read_state(node);
}

void read_injected_fault(CriterionContext& context, const JsonNode& node) {
  InjectedFaultReader(context).read_fault(node);
}

}  // namespace collidoscope
