#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

std::string vector_text(const Vector3d& v) {
  return fmt::format("{:9.3f} {:9.3f} {:9.3f}", v.x(), v.y(), v.z());
}
std::string small_vector_text(const Vector3d& v) {
  return fmt::format("{:9.2e} {:9.2e} {:9.2e}", v.x(), v.y(), v.z());
}

void draw_state(const BodyReport& body) {
  // The paper's Dynamics, after Baraff 1997.
  row_text("mass", with_prefix(body.mass, "kg"));
  row_text("radius", fmt::format("{:.4g} m", body.radius));
  row_text("X  m", vector_text(body.X), "Position of the centre of mass");
  row_text("v  m/s", vector_text(body.v), "Velocity");
  row_text("P  kg m/s", small_vector_text(body.P), "Linear momentum");
  row_text("q",
           fmt::format("  {:6.3f} {:6.3f} {:6.3f} {:6.3f}", body.q.w(), body.q.x(), body.q.y(), body.q.z()),
           "Orientation w x y z, R as a quaternion");
  row_text("ω  rad/s", vector_text(body.w), "Angular velocity");
  row_text("L  kg m²/s", small_vector_text(body.L), "Angular momentum about the centre of mass");
  const Vector3d inertia = body.inverse_inertia.diagonal();
  row_text("1/I", small_vector_text(inertia),
           "Inverse inertia tensor, its diagonal in world axes, 1/(kg m²)");
  row_text("F  N", small_vector_text(body.F), "What the next step applies: the weight");
  row_text("T  N m", small_vector_text(body.T), "Torque that the next step applies");
}

void draw_contacts(Workspace& workspace, const BodyReport& body) {
  if (body.contact_count == 0) return faint_text("no contacts");
  faint_text(fmt::format("{:<14}{:>8}{:>14}",
                         fmt::format("{} contact{}", body.contact_count, body.contact_count == 1 ? "" : "s"),
                         "overlap", "impulse"));
  // The strongest first; where no impulses are known, by the other's id.
  constexpr std::size_t most = 6;
  std::vector<const BodyReport::Contact*> order;
  for (const BodyReport::Contact& contact : body.contacts) order.push_back(&contact);
  const std::size_t shown = std::min(order.size(), most);
  std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(shown), {},
                            [](const BodyReport::Contact* c) { return std::pair(-c->impulse, c->other); });
  // Those that were not recorded are no zeros.
  const bool known = std::ranges::any_of(body.contacts, [](const auto& c) { return c.impulse != 0; });
  for (std::size_t i = 0; i < shown; ++i) {
    const BodyReport::Contact& c = *order[i];
    const std::string text = fmt::format("{:<10}{:>12}{:>14}", c.other, with_prefix(c.penetration, "m"),
                                         known ? with_prefix(c.impulse, "N s") : "–");
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(text.c_str())) workspace.selection = c.other;
    ImGui::PopID();
    track(workspace, ("inspector.contact." + std::to_string(i)).c_str());
    explain(fmt::format("Body {}: how deep the two overlap, and the normal impulse that the last step gave. "
                        "The normal towards it is {:.3f} {:.3f} {:.3f}. Click to select it",
                        c.other, c.normal.x(), c.normal.y(), c.normal.z())
                .c_str());
  }
  if (body.contact_count > static_cast<std::int64_t>(shown))
    faint_text(fmt::format("and {} more", body.contact_count - static_cast<std::int64_t>(shown)));
}

// From the leaf (left) to the root (right): a bar for each box, as wide as its diagonal's share of the
// root's.
void draw_path(const WorkspaceView& view, const BodyReport& body) {
  if (body.path.empty()) {
    faint_text("no tree, so no path");
    return;
  }
  const auto diagonal = [](const TreeLevels::Box& box) {
    return std::hypot(box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]);
  };
  faint_text(fmt::format("leaf {} of the tree, {} boxes up to the root", body.leaf, body.path.size()));
  const float width = ImGui::GetContentRegionAvail().x, row = ImGui::GetFontSize() * 0.42f;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float whole = std::max(diagonal(body.path.back()), 1e-30f);
  const std::size_t count = body.path.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float length = std::max(diagonal(body.path[i]) / whole, 0.008f) * width;
    const float y = at.y + row * static_cast<float>(i);
    const std::size_t level = count - 1 - i;
    const ImU32 color =
        view.level_colors.empty() ? 0xff808080u : view.level_colors[level % view.level_colors.size()];
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, y}, {at.x + length, y + row - 1}, color, 1);
    ImGui::GetWindowDrawList()->AddRect({at.x, y}, {at.x + length, y + row - 1},
                                        ImGui::GetColorU32(ImGuiCol_Border), 1);
  }
  ImGui::Dummy({width, row * static_cast<float>(count)});
  explain("The boxes that hold this body, from its leaf (top) to the root: each as long as its diagonal");
}

}  // namespace

void draw_inspector_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "inspector", "Body", workspace.folds.inspector)) return end_panel();
  if (view.selected == nullptr) {
    faint_text("click a body to see its state");
    return end_panel();
  }
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(fmt::format("body {}", view.selected->id).c_str());
  ImGui::SameLine();
  if (std::ranges::binary_search(view.frozen, view.selected->id)) {
    ImGui::TextColored(
        workspace.theme == Theme::light ? ImVec4(0.05f, 0.42f, 0.62f, 1) : ImVec4(0.47f, 0.84f, 1, 1),
        "frozen");
    explain(
        "A step of its own failed, or somebody asked for it: it stays where it was, and no force moves it");
    ImGui::SameLine();
  }
  ImGui::Checkbox("follow", &workspace.follow);
  track(workspace, "inspector.follow");
  ImGui::SameLine();
  ImGui::Checkbox("path", &workspace.show_path);
  track(workspace, "inspector.path");
  explain("Its boxes in the tree, from leaf to root, in the 3D view");
  ImGui::SameLine();
  const bool closed = ImGui::SmallButton("close");
  track(workspace, "inspector.close");
  ImGui::SameLine();
  if (ImGui::SmallButton("remove")) workspace.remove_wish = true;
  track(workspace, "inspector.remove");
  explain("Delete: takes the body out of the run; the ids above it move down by one");
  draw_state(*view.selected);
  draw_contacts(workspace, *view.selected);
  draw_path(view, *view.selected);
  if (closed) {
    workspace.selection.reset();
    workspace.follow = false;
  }
  end_panel();
}

}  // namespace collidoscope
