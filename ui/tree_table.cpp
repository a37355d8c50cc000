#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>

#include "ui/tree_sections.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// A metric column of the table.
struct Column {
  NodeMetric metric;
  const char *name, *label, *help;  ///< name: part of the widget names
};
constexpr std::array<Column, 5> columns{
    {{NodeMetric::level, "lvl", "level", "Level; 0 is the root"},
     {NodeMetric::sah_share, "SAH", "SAH", "Share of the tree's SAH cost"},
     {NodeMetric::sibling_overlap, "overlap", "overlap",
      "Sibling overlap: surface of the intersection of its children over its own"},
     {NodeMetric::empty_space, "empty", "empty", "Empty space: share of its volume that no child fills"},
     {NodeMetric::visits, "visits", "visits", "Queries that test its box"}}};

std::string value_text(const NodeReport& node, NodeMetric metric) {
  const auto share = [](double value) {
    return value >= 0.0995 ? fmt::format("{:.1f} %", 100 * value) : fmt::format("{:.2g} %", 100 * value);
  };
  const bool leaf = node.children == 0;
  switch (metric) {
    case NodeMetric::level:
      return std::to_string(node.level);
    case NodeMetric::sah_share:
      return node.sah_share < 1e-6 ? "<0.0001 %" : share(node.sah_share);
    case NodeMetric::sibling_overlap:
      return leaf ? "–" : fmt::format("{:.3f}", node.sibling_overlap);
    case NodeMetric::empty_space:
      return leaf ? "–" : fmt::format("{:.3f}", node.empty_space);
    case NodeMetric::visits:
      return grouped_number(node.visits);
  }
  return "";
}

}  // namespace

std::string size_text(const NodeReport& node) {
  const auto side = [&](int k) {
    return static_cast<double>(node.max[k]) - static_cast<double>(node.min[k]);
  };
  return fmt::format("{:.4g} × {:.4g} × {:.4g} m", side(0), side(1), side(2));
}

void draw_tree_table(Workspace& workspace, const WorkspaceView& view) {
  const TreePanelView& panel = *view.tree;
  TreeRequests& requests = workspace.tree;
  // ImGui keeps the width of a hidden column, so each font size uses its own table.
  const std::string table = fmt::format("nodes {}", ImGui::GetFontSize());
  if (ImGui::BeginTable(table.c_str(), 6, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg)) {
    ImGui::TableSetupColumn("node", ImGuiTableColumnFlags_WidthStretch);
    for (const Column& column : columns) ImGui::TableSetupColumn(column.name);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    faint_text("node");
    for (const Column& column : columns) {
      ImGui::TableNextColumn();
      const bool sorted = requests.sort == column.metric;
      if (ImGui::Selectable(column.label, sorted)) {
        requests.sort = column.metric;
        requests.first = 0;
      }
      track(workspace, (std::string("tree.sort.") + column.name).c_str());
      explain((std::string(column.help) + ". Click: largest first").c_str());
    }
    for (std::size_t i = 0; i < panel.rows.size(); ++i) {
      const NodeReport& node = panel.rows[i];
      const bool leaf = node.children == 0;
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      const bool chosen = leaf ? workspace.selection == node.body : requests.node == node.node;
      ImGui::PushID(static_cast<int>(i));
      ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetColorU32(ImGuiCol_ButtonActive, 0.6f));
      if (ImGui::Selectable(
              leaf ? fmt::format("body {}", node.body).c_str() : std::to_string(node.node).c_str(), chosen,
              ImGuiSelectableFlags_SpanAllColumns)) {
        requests.rank = panel.first + static_cast<std::int64_t>(i);
        workspace.playing = false;
      }
      ImGui::PopStyleColor();
      ImGui::PopID();
      track(workspace, ("tree.row." + std::to_string(i)).c_str());
      explain(fmt::format("{}. {}. Click: selects {} and pauses, since the next state has another tree",
                          size_text(node), leaf ? "Leaf" : fmt::format("{} children", node.children),
                          leaf ? "the body" : "the node")
                  .c_str());
      for (const Column& column : columns) number_cell(value_text(node, column.metric));
    }
    ImGui::EndTable();
  }
  const auto shown = static_cast<std::int64_t>(panel.rows.size());
  const auto turn = [&](const char* name, const char* label, const char* help, bool can, std::int64_t to) {
    if (!can) ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 0.4f);
    if (ImGui::SmallButton(label) && can) requests.first = to;
    if (!can) ImGui::PopStyleVar();
    track(workspace, name);
    explain(help);
    ImGui::SameLine();
  };
  turn("tree.page.first", "|<", "First page: largest values", panel.first > 0, 0);
  turn("tree.page.previous", "<", "Previous page", panel.first > 0,
       std::max<std::int64_t>(panel.first - TreePanelView::page, 0));
  turn("tree.page.next", ">", "Next page", panel.first + shown < panel.ranked,
       panel.first + TreePanelView::page);
  // Rank of the selected node, if it is on this page.
  std::optional<std::int64_t> rank;
  for (std::int64_t i = 0; i < shown; ++i) {
    const NodeReport& node = panel.rows[static_cast<std::size_t>(i)];
    if (node.children == 0 ? workspace.selection == node.body : requests.node == node.node)
      rank = panel.first + i;
  }
  for (const auto& [name, label, help, by] :
       {std::tuple{"tree.previous", "previous", "Selects the previous node of the table", -1},
        std::tuple{"tree.next", "next", "Selects the next node of the table", 1}}) {
    if (ImGui::SmallButton(label) && panel.ranked > 0) {
      requests.rank = std::clamp<std::int64_t>(rank ? *rank + by : panel.first, 0, panel.ranked - 1);
      workspace.playing = false;
    }
    track(workspace, name);
    explain(help);
    ImGui::SameLine();
  }
  faint_text(fmt::format("{}–{} of {}", grouped_number(std::min(panel.first + 1, panel.ranked)),
                         grouped_number(panel.first + shown), grouped_number(panel.ranked)));
}

}  // namespace collidoscope
