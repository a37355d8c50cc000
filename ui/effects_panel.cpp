#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "sim_cuda/scene/names.h"
#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

std::string spaced(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

/// Signed value with three decimals; "+0.000" instead of "-0.000".
std::string signed_time(double ms) {
  const std::string text = fmt::format("{:+.3f}", ms);
  return text == "-0.000" ? "+0.000" : text;
}

std::string signed_bytes(std::int64_t bytes) {
  return bytes == 0 ? "0" : (bytes < 0 ? "-" : "+") + bytes_text(std::abs(bytes));
}

/// Right-aligned text that ends at `right`, measured from the panel's left edge.
void text_to(float right, const std::string& text) {
  ImGui::SameLine(right - ImGui::CalcTextSize(text.c_str()).x);
  ImGui::TextUnformatted(text.c_str());
}

std::string cost_text(const EffectView& effect, const Effects& now) {
  std::string text = spaced(effect.name) + ": " + effect.why + ".\n";
  if (!effect.cost) return text;
  const EffectCost& cost = *effect.cost;
  if (!cost.unavailable_reason.empty()) return text + "Not measured: " + cost.unavailable_reason + ".";
  text += fmt::format(
      "A step with it: {}. The median without it is {:.4f} ms. Two worlds from state {} are stepped in "
      "turns. "
      "Bytes: difference of their buffers at that state.",
      verdict(cost.ratio, "without it"), cost.without_ms, grouped_number(cost.step));
  const Effects other = with_switched(now, effect.flag, !effect.on);
  std::string along;
  for (bool Effects::*flag : {&Effects::rotation, &Effects::friction, &Effects::rolling_resistance})
    if (flag != effect.flag && now.*flag != other.*flag)
      along += (along.empty() ? "" : ", ") + std::string(flag == &Effects::rotation   ? "rotation"
                                                         : flag == &Effects::friction ? "friction"
                                                                                      : "rolling resistance");
  if (!along.empty()) text += " Includes the effects that are switched together with it: " + along + '.';
  return text;
}

void draw_cost(const WorkspaceView& view, const EffectCost& cost) {
  const float size = ImGui::GetFontSize();
  if (!cost.unavailable_reason.empty()) {
    ImGui::SameLine(size * 12.3f);
    faint_text("not measurable");
    return;
  }
  const bool shown = view.with_times && cost.ratio.pairs > 0;
  const bool faint = shown && !cost.ratio.differs();
  const ImVec4 grey = ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled);
  ImGui::PushStyleColor(ImGuiCol_Text, faint ? grey : ImGui::GetStyleColorVec4(ImGuiCol_Text));
  text_to(size * 15.6f, shown ? signed_time(cost.ms()) : "–");
  ImGui::PopStyleColor();
  ImGui::PushStyleColor(ImGuiCol_Text, grey);
  const bool enough = shown && std::isfinite(cost.ms_high());
  text_to(size * 19.4f, enough ? fmt::format("±{:.3f}", 0.5 * (cost.ms_high() - cost.ms_low())) : "");
  ImGui::PopStyleColor();
  text_to(size * 25.0f, signed_bytes(cost.bytes));
}

/// Row of the guards. Their action on failure is a setting. They do not change the state.
void draw_guards(Workspace& workspace, const EffectView& effect, const WorkspaceView& view,
                 const Effects& now) {
  std::optional<OnFailure>& request = workspace.settings.guards;
  bool on = request.has_value();
  if (ImGui::Checkbox("guards", &on)) request = on ? std::optional(OnFailure::pause) : std::nullopt;
  track(workspace, "effects.guards");
  explain(("Checks the results of each stage for values that are not finite or out of range. " +
           cost_text(effect, now))
              .c_str());
  ImGui::SameLine(ImGui::GetFontSize() * 6.6f);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 5.2f);
  ImGui::BeginDisabled(!request);
  const std::string chosen = request ? std::string(name_of(on_failure_names, *request)) : "off";
  if (begin_choice("##guards", chosen.c_str())) {
    track(workspace, "effects.on_failure");
    for (const auto& [name, value, help] : on_failure_names) {
      if (ImGui::Selectable(std::string(name).c_str(), request == value)) request = value;
      track(workspace, ("effects.on_failure." + std::string(name)).c_str());
    }
    ImGui::EndCombo();
  } else {
    track(workspace, "effects.on_failure");
  }
  ImGui::EndDisabled();
  explain("pause: stops before the failing step. freeze: fixes the body in place and continues");
  if (effect.cost) draw_cost(view, *effect.cost);
}

void draw_effect(Workspace& workspace, const EffectView& effect, const WorkspaceView& view,
                 const Effects& now) {
  const bool greyed = !effect.on && (!effect.required || !effect.cannot.empty());
  ImGui::PushID(effect.name.c_str());
  ImGui::BeginDisabled(greyed);
  bool on = effect.on;
  if (ImGui::Checkbox(spaced(effect.name).c_str(), &on))
    workspace.settings.physics.effects = with_switched(now, effect.flag, on);
  ImGui::EndDisabled();
  track(workspace, ("effects." + effect.name).c_str());
  explain(cost_text(effect, now).c_str());
  if (greyed) {
    ImGui::SameLine(ImGui::GetFontSize() * 12.3f);
    faint_text(effect.required ? effect.cannot : effect.why);
  } else if (effect.cost) {
    draw_cost(view, *effect.cost);
  } else if (!effect.required) {
    ImGui::SameLine(ImGui::GetFontSize() * 12.3f);
    faint_text("on; not needed: " + effect.why);
  }
  ImGui::PopID();
}

}  // namespace

void draw_effects_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "effects", "Effects", workspace.visible_panels.effects)) return end_panel();
  Effects now;
  for (const EffectView& effect : view.effect_views) now.*(effect.flag) = effect.on;
  bool automatic = !workspace.settings.physics.effects.has_value();
  if (ImGui::Checkbox("auto", &automatic))
    workspace.settings.physics.effects = automatic ? std::nullopt : std::optional(now);
  track(workspace, "effects.auto");
  explain("Uses the effects that the scene needs. A switch below overrides this. Effects change the result.");
  ImGui::SameLine();
  ImGui::Checkbox("measure costs", &workspace.measure_effects);
  track(workspace, "effects.measure");
  explain(
      "Step time with an effect minus step time without it, from the present state, in two more worlds. "
      "± is half the 95 % confidence interval. "
      "The run is slower meanwhile, with the same result.");
  const bool costs = std::ranges::any_of(view.effect_views, [](const auto& e) { return e.cost.has_value(); });
  if (costs) {
    const float size = ImGui::GetFontSize();
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    text_to(size * 19.4f, "ms per step");
    text_to(size * 25.0f, view.measuring_effects ? "…" : "bytes");
    ImGui::PopStyleColor();
  }
  for (const EffectView& effect : view.effect_views)
    (effect.flag == &Effects::guards ? draw_guards : draw_effect)(workspace, effect, view, now);
  const bool any_faint = std::ranges::any_of(view.effect_views, [](const EffectView& effect) {
    return effect.cost && effect.cost->ratio.pairs > 0 && !effect.cost->ratio.differs();
  });
  if (view.with_times && any_faint) faint_text("grey ms: not distinguishable from 0");
  end_panel();
}

}  // namespace collidoscope
