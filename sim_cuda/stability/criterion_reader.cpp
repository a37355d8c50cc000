// Converts criterion files to structs. Checks types, keys, names, and references to the scene.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/patch_reader.h"
#include "sim_cuda/scene/text_file.h"
#include "sim_cuda/stability/criterion.h"
#include "sim_cuda/stability/criterion_context.h"
#include "sim_cuda/stability/injected_fault_reader.h"

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
  explicit CriterionReader(CriterionContext& context)
      : context_(context),
        document_(context.document),
        reading_(context.reading),
        criterion_(context.criterion) {}

  void read() {
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
    if (root.text("changes", criterion_.changes)) context_.check_file(*root.member("changes"));
    if (const JsonNode* run = root.member("run")) read_run_settings(*run);
    const JsonNode* found = root.member("expect_finding");
    const JsonNode* plant = root.member("inject");
    if (found != nullptr)
      read_expected_finding(*found, root);
    else
      criterion_.assertions.emplace_back().at_most = 0;  // finite
    if (plant != nullptr) read_injected_state(context_, *plant);
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
    for_each(root, "solvers", [&](const JsonNode& node) {
      const auto solver =
          node.kind == JsonKind::text ? value_of(solver_names, document_.text(node)) : std::nullopt;
      if (solver)
        criterion_.solvers.push_back(*solver);
      else
        reading_.fault(node, "\"solvers\" must be a list of \"impulse\", \"soft_step\" and \"jacobi_split\"");
    });
    for_each(root, "assertions", [&](const JsonNode& node) { read_assertion(node); });
    for_each(root, "limits", [&](const JsonNode& node) { read_expected_failure(node); });
    for_each(root, "injected_faults", [&](const JsonNode& node) { read_injected_fault(context_, node); });
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
      context_.in_range(*node, "steps", criterion_.steps, 0, most_steps);
    if (criterion_.long_steps)
      context_.in_range(*root.member("long_steps"), "long_steps", longer, criterion_.steps, most_steps);
    if (const JsonNode* node = root.member("every"))
      context_.in_range(*node, "every", criterion_.every, 1, most_steps);
  }

  void read_run_settings(const JsonNode& node) {
    ObjectReader reader(reading_, node, "\"run\"");
    read_patch(reading_, reader, criterion_.run, [](const auto& setting) {
      return !is_physical(setting) && setting.name != "executor" && setting.name != "gpu";
    });
    reader.finish();
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
    context_.read_state(reader, "from", assertion.from);
    context_.read_state(reader, "to", assertion.to);
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
      if (std::uint32_t id = 0; context_.read_id(reader, id)) assertion.body = id;
    if (quantity == Quantity::position || quantity == Quantity::velocity) {
      if (!reader.choice("axis", axis_names, assertion.axis) && reader.member("axis") == nullptr)
        reading_.fault(
            node, fmt::format("a {} must have an \"axis\": x, y or z", name_of(quantity_names, quantity)));
    }
    if (quantity == Quantity::displacement) {
      std::optional<std::int64_t> since;
      context_.read_state(reader, "since", since);
      assertion.since = since.value_or(0);
    }
    if (quantity == Quantity::difference) {
      reader.vector("offset", assertion.offset);
      if (reader.text("scene", assertion.scene))
        context_.check_file(*reader.member("scene"));
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
    context_.read_state(reader, "step", step);
    found.step = step.value_or(0);
    reader.text("stage", found.stage);
    context_.read_id(reader, found.body);
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
    const JsonNode* fails = reader.member("fails", JsonKind::array);
    if (fails != nullptr)
      for (const JsonNode& term : document_.children(*fails)) read_failing_term(term, limit);
    if (reader.is_object() &&
        (fails == nullptr ? reader.member("fails") == nullptr : fails->child_count == 0))
      reading_.fault(
          node,
          "a limit must have \"fails\", a list of terms with the bounds that must still hold, such "
          "as {\"quantity\": \"penetration\", \"at_most\": 0.1}");
    reader.finish();
    criterion_.expected_failures.push_back(std::move(limit));
  }

  void read_failing_term(const JsonNode& node, ExpectedFailure& limit) {
    ObjectReader reader(reading_, node, "a term of a limit");
    if (!reader.is_object()) return;
    const auto found = context_.read_term(reader, node, "quantity", "a term of a limit");
    ExpectedFailureTerm term;
    if (double bound = 0; reader.real("at_most", bound)) term.at_most = bound;
    if (double bound = 0; reader.real("at_least", bound)) term.at_least = bound;
    reader.finish();
    if (!found) return;
    term.assertion = *found;
    const Assertion& assertion = criterion_.assertions[term.assertion];
    if (assertion.quantity == Quantity::finite)
      return reading_.fault(node, "bodies that are not finite cannot be a limit");
    if (!term.at_most && !term.at_least)
      reading_.fault(node,
                     "a term of a limit must have the bound that still holds: \"at_most\" or \"at_least\"");
    if (term.at_most && !(assertion.at_most && *term.at_most > *assertion.at_most))
      reading_.fault(*reader.member("at_most"),
                     "\"at_most\" must be above that of the term itself, which the limit replaces");
    if (term.at_least && !(assertion.at_least && *term.at_least < *assertion.at_least))
      reading_.fault(*reader.member("at_least"),
                     "\"at_least\" must be below that of the term itself, which the limit replaces");
    if (limit.term_of(term.assertion) != nullptr) reading_.fault(node, "this term is listed twice");
    limit.fails.push_back(term);
  }

  CriterionContext& context_;
  const JsonDocument& document_;
  Reading& reading_;
  Criterion& criterion_;
};

}  // namespace

Criterion parse_criterion(const std::string& text, const std::string& name, const Scene* scene) {
  JsonDocument document(text, name, criterion_aliases);
  Criterion criterion;
  document.read_all([&](bool first) {
    CriterionContext context(document, scene);
    CriterionReader(context).read();
    if (first) criterion = std::move(context.criterion);
    return std::move(context.reading.faults);
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
