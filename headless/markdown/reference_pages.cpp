#include "headless/markdown/reference_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "headless/cli/flag_value.h"
#include "headless/markdown/cells.h"
#include "headless/reporting/report_fields.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/run/break_conditions.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/stability/criterion.h"

namespace collidoscope {

std::string effects_reference() {
  MarkdownTable table{"effect", "needed if", "requires", "description"};
  for (const EffectName& effect : effect_names)
    table.row({code(effect.name), prose(effect.needed_where), prose(effect.needs), prose(effect.what)});
  return table.text();
}

std::string broad_phases_reference() {
  MarkdownTable table{"method", "description", "traversal", "weakness"};
  for (const BroadPhaseMethod& method : broad_phase_methods)
    table.row({code(method.name), prose(method.what), prose(method.traversal), prose(method.weakness)});
  return table.text();
}

std::string breaks_reference() {
  MarkdownTable table{"condition", "limit", "met if"};
  for (const BreakConditionName& condition : break_condition_names) {
    const std::string name(condition.name);
    const std::string limit = fmt::format("{}, 0 to {}", condition.unit, number_text(condition.max_limit));
    table.row({code(condition.has_limit ? name + "=" : name), condition.has_limit ? limit : "none",
               prose(condition.meaning)});
  }
  return table.text();
}

std::string quantities_reference() {
  MarkdownTable table{"quantity", "unit", "parameters", "meaning"};
  for (const Named<Quantity>& quantity : quantity_names)
    if (quantity.value != Quantity::finite && quantity.value != Quantity::expected_finding)  // not in `holds`
      table.row({code(quantity.name), unit_text(unit_of(quantity.value)),
                 std::string(parameters_of(quantity.value)), prose(quantity.help)});
  return table.text();
}

std::string report_reference() {
  MarkdownTable table{"field", "unit", "meaning"};
  for (const ReportField& field : report_fields)
    table.row({code(field.path), unit_text(field.unit), prose(field.meaning)});
  return table.text();
}

std::span<const ReferenceTopic> reference_topics() {
  static constexpr auto topics = std::to_array<ReferenceTopic>({{"flags", flags_reference},
                                                                {"scene", scene_reference},
                                                                {"effects", effects_reference},
                                                                {"changes", changes_reference},
                                                                {"report", report_reference},
                                                                {"broad-phases", broad_phases_reference},
                                                                {"breaks", breaks_reference},
                                                                {"quantities", quantities_reference}});
  return topics;
}

std::string reference_table(std::string_view topic) {
  const auto topics = reference_topics();
  const auto known = std::ranges::find(topics, topic, &ReferenceTopic::name);
  if (known == topics.end())
    throw InputError("help --markdown: " + unknown_name("topic", topic, names_in(topics)));
  return known->table();
}

std::optional<std::string> markdown_help(const std::vector<std::string>& arguments) {
  if (arguments.size() < 2 || arguments[0] != "help") return std::nullopt;
  const auto allow = [&](std::size_t most, const char* usage) {
    if (arguments.size() > most)
      throw InputError(shown(arguments[most]) + ": unexpected argument; usage: help " + usage);
  };
  if (arguments[1] == "--man") {
    allow(3, "--man PROGRAM");
    return man_page(arguments.size() == 3 ? arguments[2] : "");
  }
  if (arguments[1] == "--completion") {
    allow(2, "--completion");
    return bash_completion();
  }
  if (arguments[1] != "--markdown") return std::nullopt;
  allow(3, "--markdown [TOPIC]");
  if (arguments.size() == 3) return reference_table(arguments[2]);
  std::string names;
  for (const ReferenceTopic& topic : reference_topics()) names += std::string(topic.name) + '\n';
  return names;
}

}  // namespace collidoscope
