// Tests that the draw data of the panels depends on their size and not on the length of the run or the size
// of the tree. `bench frames` measures the time of the same work as its part "ui".

#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>

#include "tests/gl_fixture.h"
#include "ui/panels.h"
#include "viewer/render/gui_pass.h"

namespace collidoscope {
namespace {

/// Sizes of the draw data of ImGui.
struct Drawn {
  int vertices, indices, commands;
};

/// Draw data of one frame of panels: a run of `steps` steps, and the tree panel with a query in a tree of
/// about 2 `leaves` nodes.
Drawn drawn_panels(int steps, std::int64_t leaves) {
  GuiPass gui(14);
  WorkspaceView view;
  Workspace workspace;
  History history(static_cast<std::size_t>(steps));
  std::vector<StageTime> stages;
  for (const char* name :
       {"bounds", "keys", "sort", "build", "pairs", "contacts", "colour", "solve", "walls", "move"}) {
    stages.emplace_back();
    stages.back().name = name;
    stages.back().last_ms = 0.5;
  }
  for (int k = 0; k < steps; ++k) {
    HistoryStep step;
    step.step = k;
    step.measured = true;
    step.plain_ms = k % 2 == 0 ? 3.0 : -1.0;
    history.add(step, k % 2 == 1 ? stages : std::vector<StageTime>{});
  }
  view.history = &history;
  view.tree_nodes = 2 * leaves;
  view.level_sizes.assign(18, leaves / 9);
  view.level_colors.assign(64, 0xff00ff00u);
  view.body_colors.colors.assign(256, 0xff00ffffu);
  workspace.visible_panels.tree = true;
  workspace.layers.box_color = NodeMetric::visits;
  workspace.selection = 3;
  workspace.tree.query = true;
  TreePanelView panel_view;
  panel_view.quality.nodes = panel_view.ranked = panel_view.histogram.count = 2 * leaves;
  panel_view.quality.leaves.assign(18, leaves / 18);
  panel_view.histogram.greatest = static_cast<float>(leaves);
  for (std::size_t i = 0; i <= NodeHistogram::bins; ++i)
    panel_view.histogram.edge[i] = static_cast<float>(i) / NodeHistogram::bins * static_cast<float>(leaves);
  panel_view.histogram.nodes.fill(2 * leaves / NodeHistogram::bins);
  panel_view.rows.resize(TreePanelView::page);
  panel_view.queried = 3;
  panel_view.visits = leaves / 3;
  panel_view.visited.resize(
      static_cast<std::size_t>(std::min<std::int64_t>(panel_view.visits, TreePanelView::max_visited)));
  view.tree = &panel_view;
  for (int frame = 0; frame < 3; ++frame) {  // auto-sized windows draw in their second frame
    gui.begin(1280, 720);
    draw_workspace(workspace, view);
    gui.build();
  }
  const ImDrawData& data = *ImGui::GetDrawData();
  Drawn drawn{data.TotalVtxCount, data.TotalIdxCount, 0};
  for (int k = 0; k < data.CmdListsCount; ++k) drawn.commands += data.CmdLists[k]->CmdBuffer.Size;
  return drawn;
}

TEST(PanelDrawCounts, DoNotGrowWithTheRunOrTheTree) {
  test_context();
  const Drawn few = drawn_panels(400, 9'000), many = drawn_panels(36'000, 900'000);
  EXPECT_LT(few.vertices, 32'000);
  EXPECT_LT(few.indices, 100'000);
  EXPECT_LT(few.commands, 30);
  // Larger numbers have more digits; nothing else is added.
  EXPECT_LT(many.vertices, few.vertices + 400);
  EXPECT_LT(many.indices, few.indices + 600);
  EXPECT_EQ(many.commands, few.commands);
}

}  // namespace
}  // namespace collidoscope
