#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {

void draw_numbers_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "numbers", "Energy, momentum, counts", workspace.folds.numbers))
    return end_panel();
  const StepStats& s = view.stats;
  row_text("N", grouped_number(s.bodies));
  row_text("pairs", grouped_number(s.pairs), "Boxes that overlap, found by the last step");
  row_text("contacts",
           s.split_contacts > 0
               ? fmt::format("{} ({} split)", grouped_number(s.contacts), grouped_number(s.split_contacts))
               : grouped_number(s.contacts),
           "Pairs whose shapes touch; split: those that no colour took, solved by splitting masses");
  row_text("tree",
           fmt::format("{} boxes, {} levels", grouped_number(view.tree_nodes), view.level_sizes.size()));
  row_text("memory", bytes_text(view.allocated_bytes), "Of the executor: what the simulation has allocated");
  row_text("energy", with_prefix(s.energy(), "J"),
           "Kinetic and potential, whose zero is the floor of the box");
  row_text("  kinetic", with_prefix(s.kinetic_energy, "J"));
  row_text("  potential", with_prefix(s.potential_energy, "J"));
  row_text("  by push", with_prefix(s.push_work, "J"),
           "What pushing overlapping bodies apart has added since the start");
  row_text("momentum", with_prefix(std::hypot(s.momentum[0], s.momentum[1], s.momentum[2]), "kg m/s"));
  row_text("deepest", with_prefix(s.max_penetration, "m"),
           "The deepest overlap of two bodies, or of body and wall");
  row_text("fastest", with_prefix(s.max_speed, "m/s"));
  if (s.escaped > 0) row_text("outside", grouped_number(s.escaped), "Centres outside the box");
  if (s.non_finite > 0)
    ImGui::TextColored({0.95f, 0.35f, 0.3f, 1}, "%s",
                       fmt::format("{} bodies are not finite", s.non_finite).c_str());
  end_panel();
}

}  // namespace collidoscope
