#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

std::string vector_text(const Vector3d& v) {
  return component_text(v.x()) + ' ' + component_text(v.y()) + ' ' + component_text(v.z());
}
std::string small_vector_text(const Vector3d& v) {
  return fmt::format("{:9.2e} {:9.2e} {:9.2e}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);  // no -0
}

void draw_state(const BodyReport& body) {
  // Symbols follow Baraff 1997, as in the paper.
  row_text("mass", with_prefix(body.mass, "kg"), "Mass");
  row_text("radius", fmt::format("{:.4g} m", body.radius), "Radius, of a mesh that of its bounding sphere");
  row_text("X  m", vector_text(body.X), "Position x of the centre of mass, m");
  row_text("v  m/s", vector_text(body.v), "Linear velocity, m/s");
  row_text("P  kg m/s", small_vector_text(body.P), "Linear momentum, kg m/s");
  const auto part = [](double value) { return std::abs(value) < 5e-4 ? 0.0 : value; };  // no -0
  row_text("q",
           fmt::format("  {:6.3f} {:6.3f} {:6.3f} {:6.3f}", part(body.q.w()), part(body.q.x()),
                       part(body.q.y()), part(body.q.z())),
           "Orientation as a unit quaternion w x y z");
  row_text("ω  rad/s", vector_text(body.w), "Angular velocity, rad/s");
  row_text("L  kg m²/s", small_vector_text(body.L), "Angular momentum about the centre of mass, kg m²/s");
  const Vector3d inertia = body.inverse_inertia.diagonal();
  row_text("1/I", small_vector_text(inertia),
           "Diagonal of the inverse inertia tensor in world axes, 1/(kg m²)");
  row_text("F  N", small_vector_text(body.F), "Force that the next step applies: the weight, N");
  row_text("T  N m", small_vector_text(body.T), "Torque that the next step applies, N m");
}

/// Ids of the contact partners, by descending impulse, else by id. Rows under the pointer keep their order,
/// so that a click selects the intended row.
const std::vector<std::uint32_t>& contact_rows(Workspace& workspace, const BodyReport& body) {
  constexpr std::size_t most = 6;
  Workspace::ContactRows& rows = workspace.contact_rows;
  if (rows.hovered && rows.body == body.id && !rows.others.empty()) return rows.others;
  std::vector<const BodyReport::Contact*> order;
  for (const BodyReport::Contact& contact : body.contacts) order.push_back(&contact);
  const std::size_t shown = std::min(order.size(), most);
  std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(shown), {},
                            [](const BodyReport::Contact* c) { return std::pair(-c->impulse, c->other); });
  rows.body = body.id;
  rows.others.clear();
  for (std::size_t i = 0; i < shown; ++i) rows.others.push_back(order[i]->other);
  return rows.others;
}

void draw_contacts(Workspace& workspace, const BodyReport& body) {
  const std::vector<std::uint32_t> rows = contact_rows(workspace, body);
  workspace.contact_rows.hovered = false;
  if (rows.empty()) return faint_text("no contacts");
  faint_text(fmt::format("{:<14}{:>8}{:>14}",
                         fmt::format("{} contact{}", body.contact_count, body.contact_count == 1 ? "" : "s"),
                         "depth", "impulse"));
  // Unrecorded impulses are shown as a dash, not as 0.
  const bool known = std::ranges::any_of(body.contacts, [](const auto& c) { return c.impulse != 0; });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto found = std::ranges::find(body.contacts, rows[i], &BodyReport::Contact::other);
    const bool touches = found != body.contacts.end();
    const std::string text =
        fmt::format("{:<10}{:>12}{:>14}", rows[i], touches ? with_prefix(found->penetration, "m") : "–",
                    touches && known ? with_prefix(found->impulse, "N s") : "–");
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(text.c_str())) workspace.selection = rows[i];
    ImGui::PopID();
    workspace.contact_rows.hovered |= ImGui::IsItemHovered() || ImGui::IsItemActive();
    track(workspace, ("inspector.contact." + std::to_string(i)).c_str());
    if (!touches) {
      explain(fmt::format("Body {}: no longer in contact. Click to select it", rows[i]).c_str());
      continue;
    }
    explain(fmt::format("Body {}: penetration, and normal impulse of the last step. "
                        "The normal towards it is {:.3f} {:.3f} {:.3f}. Click to select it",
                        found->other, found->normal.x(), found->normal.y(), found->normal.z())
                .c_str());
  }
  const auto shown = static_cast<std::int64_t>(std::min(rows.size(), body.contacts.size()));
  if (body.contact_count > shown) faint_text(fmt::format("and {} more", body.contact_count - shown));
}

// One bar per box from the leaf (top) to the root. Length: diagonal of the box over that of the root.
void draw_path(const WorkspaceView& view, const BodyReport& body) {
  if (body.path.empty()) {
    faint_text("this method has no tree");
    return;
  }
  const auto diagonal = [](const TreeLevels::Box& box) {
    return std::hypot(box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]);
  };
  faint_text(fmt::format("leaf {}, {} boxes from leaf to root", body.leaf, body.path.size()));
  const float width = ImGui::GetContentRegionAvail().x, row = ImGui::GetFontSize() * 0.42f;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float whole = std::max(diagonal(body.path.back()), 1e-30f);
  const std::size_t count = body.path.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float length = std::max(diagonal(body.path[i]) / whole, 0.008f) * width;
    const float y = at.y + row * static_cast<float>(i);
    const std::size_t level = count - 1 - i;
    const ImU32 color = view.level_colors.empty()
                            ? 0xff808080u
                            : view.level_colors[std::min(level, view.level_colors.size() - 1)];
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, y}, {at.x + length, y + row - 1}, color, 1);
    ImGui::GetWindowDrawList()->AddRect({at.x, y}, {at.x + length, y + row - 1},
                                        ImGui::GetColorU32(ImGuiCol_Border), 1);
  }
  ImGui::Dummy({width, row * static_cast<float>(count)});
  explain("Boxes that contain this body, from its leaf (top) to the root. Bar length: diagonal of the box");
}

/// Scrolls as far as needed to show the first rows of the panel that begins at `top`. Not away from the tree
/// panel, in which bodies are selected, too.
void scroll_into_view(const Workspace& workspace, float top) {
  const float bottom = top + 3 * ImGui::GetFrameHeightWithSpacing();
  const float scroll = bottom - ImGui::GetWindowHeight();
  if (!workspace.visible_panels.tree && scroll > ImGui::GetScrollY()) ImGui::SetScrollY(scroll);
}

}  // namespace

void draw_inspector_panel(Workspace& workspace, const WorkspaceView& view) {
  const float top = ImGui::GetCursorPosY();
  ImGuiStorage* const memory = ImGui::GetStateStorage();
  const ImGuiID last_shown = ImGui::GetID("last shown body");
  if (!begin_panel(workspace, "inspector", "Body", workspace.visible_panels.inspector)) return end_panel();
  if (view.selected == nullptr) {
    memory->SetInt(last_shown, 0);
    faint_text("click a body to see its state");
    return end_panel();
  }
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(fmt::format("body {}", view.selected->id).c_str());
  ImGui::SameLine();
  ImGui::Checkbox("follow", &workspace.follow);
  track(workspace, "inspector.follow");
  explain("The camera follows this body");
  ImGui::SameLine();
  ImGui::Checkbox("path", &workspace.show_path);
  track(workspace, "inspector.path");
  explain("Show path in tree: the boxes from leaf to root, in the 3D view");
  ImGui::SameLine();
  const bool closed = ImGui::SmallButton("deselect");
  track(workspace, "inspector.close");
  explain("Esc: deselect this body");
  ImGui::SameLine();
  if (ImGui::SmallButton("delete")) workspace.removal_requested = true;
  track(workspace, "inspector.remove");
  explain("Delete: removes the body from the run. Higher ids decrease by one");
  if (std::ranges::binary_search(view.frozen, view.selected->id)) {
    ImGui::TextColored(
        workspace.theme == Theme::light ? ImVec4(0.05f, 0.42f, 0.62f, 1) : ImVec4(0.47f, 0.84f, 1, 1),
        "frozen");
    explain("Fixed in place, by guards or by hand. No force moves it");
  }
  draw_state(*view.selected);
  draw_contacts(workspace, *view.selected);
  draw_path(view, *view.selected);
  if (closed) {
    workspace.selection.reset();
    workspace.follow = false;
  }
  const int shown = static_cast<int>(view.selected->id) + 1;
  if (memory->GetInt(last_shown) != shown) {
    memory->SetInt(last_shown, shown);
    scroll_into_view(workspace, top);
  }
  end_panel();
}

}  // namespace collidoscope
