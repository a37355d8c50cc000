#include <imgui.h>

#include <array>

#include "ui/panels.h"
#include "ui/tree_widgets.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

void layer_switch(Workspace& workspace, const char* name, const char* label, bool& on) {
  ImGui::Checkbox(label, &on);
  track(workspace, (std::string("layers.") + name).c_str());
}

void draw_contact_legend(const WorkspaceView& view) {
  if (view.max_impulse > 0 && !view.contact_colors.empty())
    draw_color_bar(view.contact_colors, "≤ " + with_prefix(view.max_impulse / 1000, "N s"), "impulse",
                   with_prefix(view.max_impulse, "N s"));
  else
    faint_text("impulses: none known of the last step");
}

}  // namespace

void draw_layers_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "layers", "Layers", workspace.folds.layers)) return end_panel();
  ShownLayers& layers = workspace.layers;
  const float column = ImGui::GetContentRegionAvail().x / 3 + ImGui::GetStyle().WindowPadding.x;
  layer_switch(workspace, "spheres", "spheres", layers.spheres);
  ImGui::SameLine(column);
  layer_switch(workspace, "contacts", "contacts", layers.contacts);
  ImGui::SameLine(2 * column - ImGui::GetStyle().WindowPadding.x);
  layer_switch(workspace, "boxes", "boxes", layers.boxes);
  layer_switch(workspace, "grid", "grid", layers.grid);
  ImGui::SameLine(column);
  layer_switch(workspace, "walls", "walls", layers.walls);
  if (view.stats.joints > 0) {
    ImGui::SameLine(2 * column - ImGui::GetStyle().WindowPadding.x);
    layer_switch(workspace, "joints", "joints", layers.joints);
  }
  if (layers.boxes) {
    draw_level_bar(workspace, view, "layers.levels");
    const std::int64_t boxes = boxes_shown(workspace, view);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted((grouped_number(boxes) + (boxes == 1 ? " box by" : " boxes by")).c_str());
    explain("What colours them; all but the level measure the tree of every state that is drawn");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    choose_box_color(workspace, "layers.box_color");
    const bool told = workspace.folds.right && workspace.folds.tree;  // by the histogram there
    if (!told) draw_color_key(view.box_colors);
  }
  static constexpr std::array<std::pair<BodyColor, const char*>, 8> colors{
      {{BodyColor::speed, "speed"},
       {BodyColor::radius, "radius"},
       {BodyColor::id, "id"},
       {BodyColor::contacts, "contacts"},
       {BodyColor::order, "order in the tree"},
       {BodyColor::depth, "depth in the tree"},
       {BodyColor::visits, "visits of the query"},
       {BodyColor::sleep, "sleep"}}};
  row_label("colour by");
  const char* chosen = "";
  for (const auto& [color, name] : colors)
    if (color == layers.color) chosen = name;
  if (begin_choice("##color", chosen)) {
    for (const auto& [color, name] : colors) {
      if (ImGui::Selectable(name, color == layers.color)) layers.color = color;
      track(workspace, (std::string("layers.color.") + name).c_str());
    }
    ImGui::EndCombo();
  }
  track(workspace, "layers.color");
  draw_color_key(view.body_colors);
  if (layers.contacts) draw_contact_legend(view);
  end_panel();
}

}  // namespace collidoscope
