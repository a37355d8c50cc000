#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <utility>

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
    faint_text("no impulses recorded in the last step");
}

// List of error scales: powers of ten, or automatic.
void choose_error_scale(Workspace& workspace, const WorkspaceView& view) {
  static constexpr std::array<int, 8> choices{0, 1, 10, 100, 1000, 10'000, 100'000, 1'000'000};
  const auto name = [&](int scale) {
    return scale > 0
               ? "× " + grouped_number(scale)
               : fmt::format("× {} (auto)", grouped_number(static_cast<std::int64_t>(view.error_scale)));
  };
  int& chosen = workspace.layers.error_scale;
  row_label("error scale", "Length of an error vector over the error");
  if (begin_choice("##error_scale", name(chosen).c_str())) {
    for (const int scale : choices) {
      const std::string text = scale > 0 ? name(scale) : "auto";
      if (ImGui::Selectable(text.c_str(), scale == chosen)) chosen = scale;
      track(workspace, ("layers.error_scale." + (scale > 0 ? std::to_string(scale) : text)).c_str());
    }
    ImGui::EndCombo();
  }
  track(workspace, "layers.error_scale");
}

// Switches of the reference layers, and the error of the run.
void draw_reference(Workspace& workspace, const WorkspaceView& view, float column) {
  FrameLayers& layers = workspace.layers;
  const ReferenceView& reference = view.reference;
  const auto reference_switch = [&](const char* name, const char* label, bool& on, const char* help) {
    ImGui::BeginDisabled(!on && !reference.unavailable_reason.empty());
    layer_switch(workspace, name, label, on);
    ImGui::EndDisabled();
    explain(reference.unavailable_reason.empty() ? help : reference.unavailable_reason.c_str());
  };
  reference_switch(
      "ghosts", "ghosts", layers.ghosts,
      "Positions of the bodies in a reference run at the same time. The reference is an event-driven "
      "simulation of hard spheres if the scene allows it, else the same run in double with 1/8 of the time "
      "step. The run waits for it");
  ImGui::SameLine(column);
  reference_switch("errors", "error vectors", layers.errors,
                   "Error vectors: from each body to its position in the reference");
  if (!reference.unavailable_reason.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s", reference.unavailable_reason.c_str());
    ImGui::PopStyleColor();
  }
  if (!layers.needs_reference()) return;
  if (layers.errors) choose_error_scale(workspace, view);
  if (reference.name.empty()) return;
  if (reference.known()) {
    faint_text(fmt::format("error {} rms, {} max", with_prefix(reference.rms, "m"),
                           with_prefix(reference.max, "m")));
    faint_text((reference.error_estimate > 0
                    ? "reference error: about " + with_prefix(reference.error_estimate, "m")
                    : "reference: " + reference.name));
    explain(fmt::format("Reference: {}, from state {}", reference.name, reference.start_state).c_str());
  }
  if (ImGui::SmallButton("restart reference")) workspace.reference_requested = true;
  track(workspace, "layers.reference");
  explain("Restarts the reference from the present state");
  ImGui::SameLine();
  faint_text(fmt::format("from state {}", grouped_number(reference.start_state)));
}

/// Starts with few levels, since all levels are thousands of boxes.
void choose_first_levels(Workspace& workspace, const WorkspaceView& view) {
  if (std::exchange(workspace.levels_chosen, true)) return;
  const int count = static_cast<int>(view.level_sizes.size());
  workspace.layers.first_level = count > 0 ? std::clamp(count - 3, 0, 2) : 2;
  workspace.layers.last_level = 4;
}

struct BodyColorChoice {
  BodyColor color;
  const char *name, *label;  ///< name: part of the widget names
};

}  // namespace

void draw_layers_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "layers", "Layers", workspace.visible_panels.layers)) return end_panel();
  FrameLayers& layers = workspace.layers;
  const float column = ImGui::GetContentRegionAvail().x / 3 + ImGui::GetStyle().WindowPadding.x;
  layer_switch(workspace, "spheres", "spheres", layers.spheres);
  ImGui::SameLine(column);
  layer_switch(workspace, "contacts", "contacts", layers.contacts);
  explain("Pairs that touch in this state. Speculative contacts are not drawn");
  ImGui::SameLine(2 * column - ImGui::GetStyle().WindowPadding.x);
  const bool had_boxes = layers.boxes;
  layer_switch(workspace, "boxes", "boxes", layers.boxes);
  if (layers.boxes && !had_boxes) choose_first_levels(workspace, view);
  layer_switch(workspace, "grid", "grid", layers.grid);
  ImGui::SameLine(column);
  layer_switch(workspace, "walls", "walls", layers.walls);
  if (view.stats.joints > 0) {
    ImGui::SameLine(2 * column - ImGui::GetStyle().WindowPadding.x);
    layer_switch(workspace, "joints", "joints", layers.joints);
  }
  draw_reference(workspace, view, column);
  if (layers.boxes) {
    draw_level_bar(workspace, view, "layers.levels");
    const std::int64_t boxes = boxes_shown(workspace, view);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted((grouped_number(boxes) + (boxes == 1 ? " box by" : " boxes by")).c_str());
    explain("Quantity that colours the boxes. All except the level measure the tree of every drawn state");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    choose_box_color(workspace, "layers.box_color");
    const bool in_histogram = workspace.visible_panels.right &&
                              workspace.visible_panels.tree;  // legend drawn by the histogram in that panel
    if (!in_histogram) draw_legend(view.box_colors);
  }
  static constexpr std::array<BodyColorChoice, 9> colors{
      {{BodyColor::speed, "speed", "speed, m/s"},
       {BodyColor::radius, "radius", "radius, m"},
       {BodyColor::id, "id", "id"},
       {BodyColor::contacts, "contacts", "contact count"},
       {BodyColor::order, "order in the tree", "tree order"},
       {BodyColor::depth, "depth in the tree", "tree depth"},
       {BodyColor::visits, "visits of the query", "query visits"},
       {BodyColor::sleep, "sleep", "sleep state"},
       {BodyColor::error, "error", "error, m"}}};
  row_label("colour by", "Quantity that colours the bodies");
  const char* chosen = "";
  for (const BodyColorChoice& choice : colors)
    if (choice.color == layers.color) chosen = choice.label;
  if (begin_choice("##color", chosen)) {
    for (const auto& [color, name, label] : colors) {
      if (ImGui::Selectable(label, color == layers.color)) layers.color = color;
      track(workspace, (std::string("layers.color.") + name).c_str());
    }
    ImGui::EndCombo();
  }
  track(workspace, "layers.color");
  draw_legend(view.body_colors);
  if (layers.contacts) draw_contact_legend(view);
  end_panel();
}

}  // namespace collidoscope
