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
  row("bodies", grouped_number(s.bodies), "Number of bodies N");
  row("memory", bytes_text(view.allocated_bytes), "Memory that the simulation has allocated on the executor");
  row("pairs", grouped_number(s.pairs), "Pairs of overlapping boxes in the last step");
  row("touching", grouped_number(s.touching), "Pairs whose shapes touch in this state");
  row("speculative", grouped_number(s.speculative),
      "Contacts of the last step: pairs that touched at its start or could touch within it");
  row("tree", fmt::format("{} levels", view.level_sizes.size()), "Levels of the tree");
  row("boxes", grouped_number(view.tree_nodes), "Boxes on all levels of the tree");
  row("E kinetic", with_prefix(s.kinetic_energy, "J"), "Kinetic energy of translation and rotation");
  row("E potential", with_prefix(s.potential_energy, "J"), "Potential energy; 0 at the floor of the box");
  row("E total", with_prefix(s.energy(), "J"), "Kinetic plus potential energy");
  row("E correction", with_prefix(s.push_work, "J"),
      "Correction work: potential energy that overlap recovery has added since the start");
  row("penetration", with_prefix(s.max_penetration, "m"),
      "Max penetration of two bodies, or of a body and a wall");
  if (s.joints > 0) {
    row("joints", grouped_number(s.joints), "Number of joints");
    row("joint error", with_prefix(s.max_joint_error, "m"),
        "Max joint error: distance from the target position");
  }
  if (s.can_sleep) {
    row("asleep", grouped_number(s.asleep), "Sleeping bodies: not simulated until they are touched");
    row("islands", fmt::format("{} of {}", grouped_number(s.islands_asleep), grouped_number(s.islands)),
        "Sleeping islands of all islands. Bodies of an island are in contact, and sleep and wake together");
  }
  row("max speed", with_prefix(s.max_speed, "m/s"), "Speed of the fastest body");
  row("uncoloured", grouped_number(s.uncoloured_contacts),
      "Contacts without a colour, solved with mass splitting");
  row("escaped", grouped_number(s.escaped), "Bodies whose centre is outside the box");
  row_text("momentum", with_prefix(std::hypot(s.momentum[0], s.momentum[1], s.momentum[2]), "kg m/s"),
           "Magnitude of the total linear momentum");
  if (s.non_finite > 0)
    ImGui::TextColored({0.95f, 0.35f, 0.3f, 1}, "%s",
                       fmt::format("{} bodies with non-finite values", s.non_finite).c_str());
  end_panel();
}

}  // namespace collidoscope
