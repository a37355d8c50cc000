// Converts criterion files to structs. Checks types, keys, names, and references to the scene.
// More than 400 lines: one reader per key of the format.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/patch_reader.h"
#include "sim_cuda/scene/text_file.h"
#include "sim_cuda/stability/criterion.h"

namespace collidoscope {
namespace {

constexpr JsonAlias criterion_aliases[] = {{"assertions", "holds"},
                                           {"injected_faults", "faults"},
                                           {"inject", "plant"},
                                           {"expect_finding", "found"},
                                           {"initial_pair_capacity", "pair_capacity"},
                                           {"angular_speed", "spin"}};

constexpr std::int64_t most_steps = 1'000'000'000;
constexpr std::array<Named<int>, 3> axis_names{{{"x", 0}, {"y", 1}, {"z", 2}}};

constexpr bool is_of_a_body(Quantity quantity) {
  return quantity == Quantity::displacement || quantity == Quantity::position ||
         quantity == Quantity::velocity;
}

class CriterionReader {
 public:
  CriterionReader(const JsonDocument& document, const Scene* scene)
      : document_(document),
        reading_{document, document.faults()},
        scene_(scene),
        bodies_(scene != nullptr ? bodies_of(*scene) : 0) {}

  /// Reads the criterion and returns all faults.
  std::vector<JsonFault> read(Criterion& criterion) {
    ObjectReader root(reading_, document_.root(), "a criterion");
    if (root.is_object()) {
      root.header("collidoscope-criterion", "a criterion");
      read_what(root);
      if (const JsonNode* refused = root.member("refused", JsonKind::array))
        read_refused(*refused, root);
      else
        read_run(root);
    }
    root.finish();
    criterion = std::move(criterion_);
    return std::move(reading_.faults);
  }

 private:
  void read_what(ObjectReader& root) {
    if (!root.text("what", criterion_.what) && root.member("what") == nullptr)
      reading_.fault(document_.root(), "\"what\" is missing: expected one line that describes the criterion");
    if (root.text("group", criterion_.group)) {
      if (std::ranges::find(hard_case_groups, criterion_.group) == hard_case_groups.end())
        reading_.fault(*root.member("group"), unknown_name("group", criterion_.group, hard_case_groups));
    } else if (root.member("group") == nullptr) {
      reading_.fault(document_.root(), fmt::format("\"group\" is missing: {}", either_of(hard_case_groups)));
    }
  }

  void read_refused(const JsonNode& list, ObjectReader& root) {
    for (const JsonNode& child : document_.children(list)) {
      if (child.kind == JsonKind::text)
        criterion_.refused.emplace_back(document_.text(child));
      else
        reading_.fault(
            child,
            "\"refused\" must be a list of strings: a part of each line with which the scene is refused");
    }
    if (list.child_count == 0) reading_.fault(list, "\"refused\" must contain at least one string");
    criterion_.executors.push_back(ExecutorKind::cpu);
    for (const char* key : {"steps", "assertions", "injected_faults", "limits"})
      if (const JsonNode* node = root.member(key))
        reading_.fault_at_key(
            *node, fmt::format("\"refused\" and \"{}\" exclude each other; remove one of them", key));
  }

  void read_run(ObjectReader& root) {
    read_steps(root);
    if (root.text("changes", criterion_.changes)) check_file(*root.member("changes"));
    if (const JsonNode* run = root.member("run")) read_run_settings(*run);
    const JsonNode* found = root.member("expect_finding");
    const JsonNode* plant = root.member("inject");
    if (found != nullptr)
      read_expected_finding(*found, root);
    else
      criterion_.assertions.emplace_back().at_most = 0;  // finite
    if (plant != nullptr) read_injected_state(*plant);
    if (plant != nullptr && found == nullptr)
      reading_.fault_at_key(*plant, "\"inject\" is valid only with \"expect_finding\"");
    for_each(root, "executors", [&](const JsonNode& node) {
      const auto kind =
          node.kind == JsonKind::text ? value_of(executor_names, document_.text(node)) : std::nullopt;
      if (kind && *kind != ExecutorKind::automatic)
        criterion_.executors.push_back(*kind);
      else
        reading_.fault(node, "\"executors\" must be a list of \"cpu\" and \"cuda\"");
    });
    for_each(root, "assertions", [&](const JsonNode& node) { read_assertion(node); });
    for_each(root, "limits", [&](const JsonNode& node) { read_expected_failure(node); });
    for_each(root, "injected_faults", [&](const JsonNode& node) { read_injected_fault(node); });
  }

  template <class Read>
  void for_each(ObjectReader& root, std::string_view key, Read read) {
    if (const JsonNode* list = root.member(key, JsonKind::array))
      for (const JsonNode& node : document_.children(*list)) read(node);
  }

  void read_steps(ObjectReader& root) {
    if (!root.whole("steps", criterion_.steps) && root.member("steps") == nullptr)
      reading_.fault(document_.root(), "\"steps\" is missing: expected the number of steps of the run");
    std::int64_t longer = 0;
    if (root.whole("long_steps", longer)) criterion_.long_steps = longer;
    root.whole("every", criterion_.every);
    if (const JsonNode* node = root.member("steps"))
      in_range(*node, "steps", criterion_.steps, 0, most_steps);
    if (criterion_.long_steps)
      in_range(*root.member("long_steps"), "long_steps", longer, criterion_.steps, most_steps);
    if (const JsonNode* node = root.member("every"))
      in_range(*node, "every", criterion_.every, 1, most_steps);
  }

  bool in_range(const JsonNode& node, std::string_view key, std::int64_t value, std::int64_t least,
                std::int64_t most) {
    if (value >= least && value <= most) return true;
    reading_.fault(node, fmt::format("\"{}\" must be a whole number from {} to {}, not {}", key, least, most,
                                     printable(document_.token(node))));
    return false;
  }

  void read_run_settings(const JsonNode& node) {
    ObjectReader reader(reading_, node, "\"run\"");
    read_patch(reading_, reader, criterion_.run, [](const auto& setting) {
      return !is_physical(setting) && setting.name != "executor" && setting.name != "gpu";
    });
    reader.finish();
  }

  /// Checks the name of a file in the criterion's folder.
  void check_file(const JsonNode& node) {
    const std::string_view name = document_.text(node);
    if (name.empty() || name.find('/') != std::string_view::npos || !name.ends_with(".json"))
      reading_.fault(node, "must be the name of a file (.json) in the criterion's own folder");
  }

  /// Reads a body id. Returns false and adds a fault if neither the scene nor a change can provide that body.
  bool read_id(ObjectReader& reader, std::uint32_t& id) {
    std::int64_t number = 0;
    if (!reader.whole("body", number)) return false;
    const std::int64_t count = scene_ != nullptr && criterion_.changes.empty() ? bodies_ : limits::max_bodies;
    if (!in_range(*reader.member("body"), "body", number, 0, std::max<std::int64_t>(count, 1) - 1))
      return false;
    id = static_cast<std::uint32_t>(number);
    return true;
  }

  void read_state(ObjectReader& reader, std::string_view key, std::optional<std::int64_t>& state) {
    std::int64_t number = 0;
    const std::int64_t most = criterion_.long_steps.value_or(criterion_.steps);
    if (reader.whole(key, number) && in_range(*reader.member(key), key, number, 0, most)) state = number;
  }

  void read_assertion(const JsonNode& node) {
    Assertion assertion;
    ObjectReader reader(reading_, node, "a term");
    if (!reader.is_object()) return;
    const bool named = reader.choice("quantity", quantity_names, assertion.quantity);
    if (!named && reader.member("quantity") == nullptr)
      reading_.fault(node, "a term must have a \"quantity\", the name of the measured quantity");
    if (named && assertion.quantity == Quantity::finite)
      reading_.fault(node, "\"finite\" is always checked; remove this term");
    if (named && assertion.quantity == Quantity::expected_finding)
      reading_.fault(node, "\"found\" is set by \"expect_finding\" beside \"assertions\"; remove this term");
    if (double bound = 0; reader.real("at_most", bound)) assertion.at_most = bound;
    if (double bound = 0; reader.real("at_least", bound)) assertion.at_least = bound;
    if (!assertion.at_most && !assertion.at_least && reader.member("at_most") == nullptr &&
        reader.member("at_least") == nullptr)
      reading_.fault(node, "a term must have a bound: \"at_most\", \"at_least\" or both");
    if (assertion.at_most && assertion.at_least && *assertion.at_least > *assertion.at_most)
      reading_.fault(*reader.member("at_least"), "\"at_least\" must not exceed \"at_most\"");
    read_state(reader, "from", assertion.from);
    read_state(reader, "to", assertion.to);
    if (assertion.from && assertion.to && *assertion.from > *assertion.to)
      reading_.fault(*reader.member("to"), "\"to\" must not be before \"from\"");
    if (named) read_parameters(reader, node, assertion);
    reader.finish();
    criterion_.assertions.push_back(std::move(assertion));
  }

  /// Reads parameters that only some quantities accept.
  void read_parameters(ObjectReader& reader, const JsonNode& node, Assertion& assertion) {
    const Quantity quantity = assertion.quantity;
    if (is_of_a_body(quantity))
      if (std::uint32_t id = 0; read_id(reader, id)) assertion.body = id;
    if (quantity == Quantity::position || quantity == Quantity::velocity) {
      if (!reader.choice("axis", axis_names, assertion.axis) && reader.member("axis") == nullptr)
        reading_.fault(
            node, fmt::format("a {} must have an \"axis\": x, y or z", name_of(quantity_names, quantity)));
    }
    if (quantity == Quantity::displacement) {
      std::optional<std::int64_t> since;
      read_state(reader, "since", since);
      assertion.since = since.value_or(0);
    }
    if (quantity == Quantity::difference) {
      reader.vector("offset", assertion.offset);
      if (reader.text("scene", assertion.scene))
        check_file(*reader.member("scene"));
      else if (reader.member("scene") == nullptr)
        reading_.fault(node, "a difference must have a \"scene\", the file of the scene to compare with");
    }
    if (quantity == Quantity::other_hash) {
      for_each(reader, "shapes", [&](const JsonNode& shape) { read_shape(shape, assertion); });
      for_each(reader, "broad_phases", [&](const JsonNode& name) { read_broad_phase(name, assertion); });
      if (reader.member("shapes") == nullptr && reader.member("broad_phases") == nullptr)
        reading_.fault(node,
                       "other_hash must have \"shapes\" [[B, T], ...] or \"broad_phases\" to compare with");
    }
  }

  void read_shape(const JsonNode& node, Assertion& assertion) {
    const auto children = document_.children(node);
    int sides[2] = {0, 0};
    bool good = node.kind == JsonKind::array && children.size() == 2;
    for (std::size_t k = 0; good && k < 2; ++k) {
      const std::optional<double> number =
          children[k].kind == JsonKind::number ? document_.number(children[k]) : std::nullopt;
      good = number && *number >= 1 && *number <= (k == 0 ? 2147483647.0 : 1024.0) &&
             *number == std::floor(*number);
      if (good) sides[k] = static_cast<int>(*number);
    }
    if (!good) return reading_.fault(node, "a shape must be [B, T]: 1 or more blocks, and 1 to 1024 threads");
    assertion.shapes.push_back({sides[0], sides[1]});
  }

  void read_broad_phase(const JsonNode& node, Assertion& assertion) {
    std::vector<std::string> known = broad_phase_names();
    known.emplace_back("all");
    const std::string name(node.kind == JsonKind::text ? document_.text(node) : document_.token(node));
    if (std::ranges::find(known, name) == known.end())
      return reading_.fault(
          node, unknown_name("broad phase", name, std::vector<std::string_view>(known.begin(), known.end())));
    if (name == "all")
      assertion.every_broad_phase = true;
    else
      assertion.broad_phases.push_back(name);
  }

  void read_expected_finding(const JsonNode& node, ObjectReader& root) {
    ObjectReader reader(reading_, node, "\"expect_finding\"");
    ExpectedFinding& found = criterion_.expected_finding.emplace();
    std::optional<std::int64_t> step;
    read_state(reader, "step", step);
    found.step = step.value_or(0);
    reader.text("stage", found.stage);
    read_id(reader, found.body);
    for (const char* key : {"step", "stage", "body"})
      if (reader.is_object() && reader.member(key) == nullptr)
        reading_.fault(node, "\"expect_finding\" must have a \"step\", a \"stage\" and a \"body\"");
    reader.finish();
    Assertion& assertion = criterion_.assertions.emplace_back();
    assertion.quantity = Quantity::expected_finding;
    assertion.at_least = 1;
    if (const JsonNode* holds = root.member("assertions"))
      reading_.fault_at_key(*holds, "a case cannot have both; remove \"expect_finding\" or \"assertions\"");
  }

  void read_injected_state(const JsonNode& node) {
    ObjectReader reader(reading_, node, "\"inject\"");
    InjectedFault injected;
    if (reader.is_object()) read_injected(reader, node, injected);
    reader.finish();
    criterion_.injected_state = injected.state;
  }

  void read_expected_failure(const JsonNode& node) {
    ExpectedFailure limit;
    ObjectReader reader(reading_, node, "a limit");
    const auto choice = [&](std::string_view key, const auto& table, auto& value) {
      typename std::remove_reference_t<decltype(value)>::value_type read{};
      if (reader.choice(key, table, read)) value = read;
    };
    choice("solver", solver_names, limit.solver);
    choice("precision", precision_names, limit.precision);
    choice("executor", executor_names, limit.executor);
    if (!reader.text("why", limit.why) && reader.is_object() && reader.member("why") == nullptr)
      reading_.fault(node, "a limit must have a \"why\", the reason in one line");
    if (reader.is_object() && reader.member("solver") == nullptr && reader.member("precision") == nullptr &&
        reader.member("executor") == nullptr)
      reading_.fault(node, "a limit must have a \"solver\", a \"precision\" or an \"executor\"");
    reader.finish();
    criterion_.expected_failures.push_back(std::move(limit));
  }

  void read_injected_fault(const JsonNode& node) {
    InjectedFault fault;
    ObjectReader reader(reading_, node, "a fault");
    if (!reader.is_object()) return;
    read_failing_assertion(reader, node, fault);
    const JsonNode* set = reader.member("set");
    if (set != nullptr) {
      read_set(*set, fault);
    } else if (reader.text("scene", fault.scene)) {
      check_file(*reader.member("scene"));
    } else if (reader.member("scene") == nullptr) {
      read_injected(reader, node, fault);
    }
    reader.finish();
    criterion_.injected_faults.push_back(std::move(fault));
  }

  void read_failing_assertion(ObjectReader& reader, const JsonNode& node, InjectedFault& fault) {
    Quantity quantity{};
    int number = 1;
    const bool numbered = reader.whole("term", number);
    if (!reader.choice("fails", quantity_names, quantity)) {
      if (reader.member("fails") == nullptr)
        reading_.fault(node, "a fault must have \"fails\", the name of a quantity of the assertions");
      return;
    }
    int found = 0;
    for (std::size_t k = 0; k < criterion_.assertions.size(); ++k)
      if (criterion_.assertions[k].quantity == quantity && ++found == number) {
        fault.assertion = k;
        return;
      }
    reading_.fault(
        numbered ? *reader.member("term") : *reader.member("fails"),
        fmt::format("\"assertions\" has {} of the quantity \"{}\"",
                    found == 0 ? "none" : fmt::to_string(found), name_of(quantity_names, quantity)));
  }

  void read_set(const JsonNode& node, InjectedFault& fault) {
    ObjectReader reader(reading_, node, "\"set\"");
    SettingsPatch& set = fault.set.emplace();
    read_patch(reading_, reader, set, [](const auto& setting) { return is_physical(setting); });
    reader.finish();
    if (set.of_generator() && scene_ != nullptr && scene_->generators.size() != 1)
      reading_.fault(node, "settings of a generator need a scene with one generator");
  }

  void read_injected(ObjectReader& reader, const JsonNode& node, InjectedFault& fault) {
    InjectedState& injected = fault.state.emplace();
    std::optional<std::int64_t> step;
    read_state(reader, "step", step);
    injected.step = step.value_or(0);
    if ((!read_id(reader, injected.body) && reader.member("body") == nullptr) ||
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

  const JsonDocument& document_;
  Reading reading_;
  const Scene* scene_;
  std::int64_t bodies_;
  Criterion criterion_;
};

}  // namespace

Criterion parse_criterion(const std::string& text, const std::string& name, const Scene* scene) {
  JsonDocument document(text, name, criterion_aliases);
  Criterion criterion;
  document.read_all([&](bool first) {
    Criterion other;
    return CriterionReader(document, scene).read(first ? criterion : other);
  });
  criterion.file = name;
  criterion.warnings = document.warnings();
  return criterion;
}

Criterion read_criterion(const std::string& file, const Scene* scene) {
  return parse_criterion(read_text_file(file, JsonDocument::max_bytes, "a criterion (.criterion.json)"), file,
                         scene);
}

}  // namespace collidoscope
