#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {

void draw_numbers_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "numbers", "Energy, momentum, counts", workspace.visible_panels.numbers))
    return end_panel();
  const StepStats& s = view.stats;
  TextPairs row;
  row("N", grouped_number(s.bodies));
  row("memory", bytes_text(view.allocated_bytes), "Of the executor: what the simulation has allocated");
  row("pairs", grouped_number(s.pairs), "Boxes that overlap, found by the last step");
  row("touching", grouped_number(s.touching), "Pairs whose shapes touch in this state");
  row("speculative", grouped_number(s.speculative),
      "Contacts of the last step: pairs that touched at its start, or that its motion could bring together");
  row("tree", fmt::format("{} levels", view.level_sizes.size()));
  row("boxes", grouped_number(view.tree_nodes), "Of all levels of the tree");
  row("kinetic", with_prefix(s.kinetic_energy, "J"), "Energy of translation and rotation");
  row("potential", with_prefix(s.potential_energy, "J"), "Its zero is the floor of the box");
  row("energy", with_prefix(s.energy(), "J"), "Kinetic and potential");
  row("by push", with_prefix(s.push_work, "J"),
      "What pushing overlapping bodies apart has added to the energy since the start");
  row("deepest", with_prefix(s.max_penetration, "m"),
      "The deepest overlap of two bodies, or of body and wall");
  if (s.joints > 0) {
    row("joints", grouped_number(s.joints));
    row("furthest", with_prefix(s.max_joint_error, "m"), "What a joint holds, from where it should be");
  }
  if (s.can_sleep) {
    row("asleep", grouped_number(s.asleep),
        "Bodies that sleep: neither solved nor moved until they are touched");
    row("islands", fmt::format("{} of {}", grouped_number(s.islands_asleep), grouped_number(s.islands)),
        "Islands that sleep, of all: bodies that touch, or soon may, sleep and wake together");
  }
  row("fastest", with_prefix(s.max_speed, "m/s"));
  row("split", grouped_number(s.split_contacts),
      "Contacts that no colour took, solved by splitting the masses of their bodies");
  row("outside", grouped_number(s.escaped), "Centres outside the box");
  row_text("momentum", with_prefix(std::hypot(s.momentum[0], s.momentum[1], s.momentum[2]), "kg m/s"));
  if (s.non_finite > 0)
    ImGui::TextColored({0.95f, 0.35f, 0.3f, 1}, "%s",
                       fmt::format("{} bodies are not finite", s.non_finite).c_str());
  end_panel();
}

}  // namespace collidoscope
