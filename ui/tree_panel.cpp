// Panel Tree: quality measures, histogram of the metric that colours the boxes, worst nodes, and the query of
// a body. Measured only while the panel is open.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "ui/panels.h"
#include "ui/tree_sections.h"
#include "ui/tree_widgets.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

// Number of leaves per level, aligned with the level bar.
void draw_depths(Workspace& workspace, const WorkspaceView& view) {
  const std::vector<std::int64_t>& leaves = view.tree->quality.leaves;
  const float width = ImGui::GetContentRegionAvail().x, height = 1.8f * ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("depths", {width, height});
  const std::int64_t most = std::max<std::int64_t>(*std::ranges::max_element(leaves), 1);
  const float cell = width / static_cast<float>(leaves.size());
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.55f), 3);
  for (std::size_t level = 0; level < leaves.size(); ++level) {
    const float x = at.x + cell * static_cast<float>(level);
    const float bar = height * static_cast<float>(leaves[level]) / static_cast<float>(most);
    if (leaves[level] > 0)
      list->AddRectFilled({x + 1, at.y + height - std::max(bar, 1.5f)}, {x + cell - 1, at.y + height},
                          ImGui::GetColorU32(ImGuiCol_SliderGrab), 1);
  }
  if (ImGui::IsItemHovered()) {
    const auto level =
        std::min(static_cast<std::size_t>(std::max((ImGui::GetIO().MousePos.x - at.x) / cell, 0.0f)),
                 leaves.size() - 1);
    const std::int64_t boxes = level < view.level_sizes.size() ? view.level_sizes[level] : 0;
    explain(fmt::format("Leaves by level. Level {}: {} of {} boxes are leaves, with one body each", level,
                        grouped_number(leaves[level]), grouped_number(boxes))
                .c_str());
  }
  draw_level_bar(workspace, view, "tree.levels");
}

void draw_quality(const WorkspaceView& view) {
  const TreeQuality& q = view.tree->quality;
  TextPairs row;
  const auto number = [](double value) { return fmt::format("{:.4g}", value); };
  row("SAH cost", number(q.sah),
      "Surface area heuristic: areas of all boxes, leaves twice, over the root's area. Cost of a random ray");
  row("EPO", number(q.epo),
      "End point overlap: share of the area of the bodies' boxes inside boxes that do not contain them, "
      "leaves "
      "counted twice (Aila, Karras, Laine 2013)");
  row("overlap", number(q.sibling_overlap),
      "Sibling overlap: surface of the intersection of siblings over their parent's. Mean of inner nodes");
  row("empty space", number(q.empty_space), "Share of a box that no child fills. Mean of inner nodes");
  row("own visits", number(q.own.mean), "Nodes that the method's own traversal reads per body. Mean");
  row("own max", q.own.by_query ? grouped_number(q.own.max) : "-",
      "Max own visits of a query. Not available for methods without a query per body");
  row("root visits", number(q.visits_mean),
      "Boxes that a query from the root tests per body, by the same algorithm for each tree. Mean. "
      "The values below and the colours refer to this query");
  row("root p99", number(q.visits_p99), "99th percentile of the visits per query");
  row("root max", grouped_number(q.visits_max), "Max visits of a query");
  row("divergence", fmt::format("× {:.3g}", q.warp_ratio),
      "Warp divergence: mean of the max visits in each warp of 32 queries, over the mean visits");
  row("exp. visits", number(q.expected_visits),
      "Expected visits of a query at a random place: Σ Π(extent + 2·half extent)/V");
  row("tests/pair", number(q.tests_per_pair),
      "Tests per true pair: box tests of all queries over the number of overlapping pairs");
  row("nodes", grouped_number(q.nodes), "Inner nodes and leaves");
  row("memory", bytes_text(q.bytes), "Memory of the broad phase, including the tree");
}

}  // namespace

void draw_tree_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "tree", "Tree", workspace.visible_panels.tree)) return end_panel();
  row_label("method", "Algorithm that finds overlapping pairs; never changes the result");
  choose_broad_phase(workspace, view, "tree.method");
  if (!view.given_tree.empty())
    row_text("shown", view.given_tree, "The tree of this file, instead of that of the broad phase");
  if (view.tree == nullptr) {
    faint_text("not measured yet");
    return end_panel();
  }
  const TreePanelView& panel = *view.tree;
  if (panel.quality.nodes == 0) {
    faint_text("this method has no tree");
    return end_panel();
  }
  draw_quality(view);
  faint_text(view.with_times
                 ? fmt::format("state {}, measured in {} ms{}", panel.step, short_time(panel.took_ms),
                               panel.took_ms > 20 && workspace.playing ? ", at intervals" : "")
                 : fmt::format("state {}", panel.step));
  explain(
      "Measured only while this panel is open or a colour needs it. During play the panel uses at most a "
      "fifth "
      "of the time. Colours always show the drawn state");
  ImGui::Spacing();
  draw_depths(workspace, view);
  ImGui::Checkbox("boxes", &workspace.layers.boxes);
  track(workspace, "tree.boxes");
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("by");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  choose_box_color(workspace, "tree.color");
  draw_tree_histogram(workspace, view);
  ImGui::Spacing();
  draw_tree_table(workspace, view);
  draw_tree_selection(workspace, view);
  end_panel();
}

}  // namespace collidoscope
