// The hard cases: scenes that try to break the simulation, by group, each with a mark for every solver in
// either precision. A click on a case opens its scene; a click on a mark opens it with that solver in that
// precision, at the state where it failed.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/hard_mark.h"
#include "ui/panels.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// Where marks stand: two columns for each solver, from the right edge.
struct Columns {
  explicit Columns(float right_edge) : size(ImGui::GetFontSize()), right(right_edge) {}
  float cell() const { return 1.75f * size; }
  float gap() const { return 0.55f * size; }
  float width() const { return static_cast<float>(solver_names.size()) * (2 * cell() + gap()); }
  float left() const { return right - width(); }  ///< of all, with a gap before the first
  float left(Solver solver) const {
    return left() + gap() + static_cast<float>(solver) * (2 * cell() + gap());
  }
  float left(const HardTrialFacts& trial) const {
    return left(trial.solver) + (trial.precision == Precision::f64 ? cell() : 0);
  }

  float size, right;
};

std::string trial_name(const HardTrialFacts& trial) {
  return fmt::format("{} {}", name_of(solver_names, trial.solver), name_of(precision_names, trial.precision));
}

/// As much of it as there is room for.
std::string fitted(const std::string& text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  std::string part = text;
  while (!part.empty() && ImGui::CalcTextSize((part + "…").c_str()).x > width) part.pop_back();
  return part + "…";
}

/// `width`: pixels; 0: as wide as the panel.
void wrapped(const std::string& text, bool faint, float width = 0) {
  ImGui::PushStyleColor(ImGuiCol_Text,
                        ImGui::GetStyleColorVec4(faint ? ImGuiCol_TextDisabled : ImGuiCol_Text));
  ImGui::PushTextWrapPos(width);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

/// A mark in a line of text, and what follows it.
void marked(HardMark mark, bool light, const std::string& text) {
  const float size = ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  draw_hard_mark({at.x + 0.5f * size, at.y + 0.5f * size}, size, mark, 0, light);
  ImGui::Dummy({size, size});
  ImGui::SameLine();
  ImGui::TextUnformatted(text.c_str());
}

void trial_tooltip(const HardCaseFacts& one, const HardTrialFacts& trial, bool with_times, bool light) {
  const float width = ImGui::GetFontSize() * 30;
  ImGui::BeginTooltip();
  ImGui::TextUnformatted((one.refused ? one.name : one.name + " · " + trial_name(trial)).c_str());
  std::string line(name_of(hard_mark_names, trial.mark));
  if (trial.mark == HardMark::running) line += fmt::format(", {:.0f} %", std::floor(100 * trial.progress));
  if (trial.over() && trial.steps > 0) {
    line += fmt::format(", {} steps", grouped_number(trial.steps));
    if (with_times) line += fmt::format(" in {:.3g} s", trial.seconds);
  }
  marked(trial.mark, light, line);
  if (!trial.why.empty() && trial.why != trial.failure) wrapped(trial.why, false, width);
  if (trial.terms.empty() && !trial.failure.empty()) wrapped(trial.failure, false, width);
  if (!trial.terms.empty()) ImGui::Separator();
  for (const HardTermFacts& term : trial.terms) {
    ImGui::TextUnformatted(term.term.c_str());
    ImGui::PushStyleColor(ImGuiCol_Text, term.held ? ImGui::GetColorU32(ImGuiCol_TextDisabled)
                                                   : hard_mark_color(HardMark::failed, light));
    ImGui::TextUnformatted(
        fmt::format("    {} {} at state {}{}", term.held ? "at worst" : "fails:", term.value,
                    grouped_number(term.state), term.body ? fmt::format(", body {}", *term.body) : "")
            .c_str());
    ImGui::PopStyleColor();
  }
  if (!one.refused && trial.mark != HardMark::not_applicable)
    faint_text(trial.failed_state
                   ? fmt::format("A click opens it at state {}", grouped_number(*trial.failed_state))
                   : "A click opens it from state 0");
  ImGui::EndTooltip();
}

void draw_buttons(Workspace& workspace, const HardCasesFacts& facts) {
  const float size = ImGui::GetFontSize();
  HardCasesWishes& wishes = workspace.hard_cases;
  std::int64_t all = 0, over = 0;
  for (const HardCaseFacts& one : facts.cases) {
    all += std::ssize(one.trials);
    over += std::ranges::count_if(one.trials, &HardTrialFacts::over);
  }
  const bool running = !facts.doing.empty() || facts.opening;
  const double share = facts.opening
                           ? *facts.opening
                           : static_cast<double>(over) / static_cast<double>(std::max<std::int64_t>(all, 1));
  const std::string text = facts.opening ? fmt::format("on the way: {:.0f} %", std::floor(100 * share))
                                         : fmt::format("{} of {} trials", over, all);
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  ImGui::ProgressBar(static_cast<float>(share), {ImGui::GetContentRegionAvail().x - 12.6f * size, 0},
                     text.c_str());
  ImGui::PopStyleColor();
  explain(
      fmt::format("{}; on {}", facts.doing.empty() ? "nothing runs" : facts.doing, facts.executor).c_str());
  ImGui::SameLine();
  const char* const label = running ? "stop" : over == 0 ? "run all" : over < all ? "go on" : "run again";
  if (ImGui::Button(label, {5.4f * size, 0})) (running ? wishes.stop : wishes.run_all) = true;
  track(workspace, "hard_cases.run_all");
  explain("All cases with each solver in each precision, in slices: the scene goes on meanwhile");
  ImGui::SameLine();
  const bool any =
      std::ranges::any_of(facts.cases, [&](const auto& one) { return one.name == wishes.selected; });
  ImGui::BeginDisabled(!any);
  if (ImGui::Button("run selected", {-1, 0})) wishes.run_selected = true;
  ImGui::EndDisabled();
  track(workspace, "hard_cases.run");
  if (any) explain(("Runs " + wishes.selected + " with each solver in each precision").c_str());
}

/// What has come of all, and with it what the marks mean.
void draw_counts(const HardCasesFacts& facts, bool light) {
  constexpr std::pair<HardMark, const char*> kinds[] = {{HardMark::passed, "passed"},
                                                        {HardMark::declared_limit, "limit"},
                                                        {HardMark::failed, "failed"},
                                                        {HardMark::not_applicable, "n/a"}};
  const float width = ImGui::GetContentRegionAvail().x / 4, left = ImGui::GetCursorPosX();
  for (int k = 0; k < 4; ++k) {
    if (k > 0) ImGui::SameLine(left + static_cast<float>(k) * width);
    ImGui::BeginGroup();
    marked(kinds[k].first, light, fmt::format("{} {}", facts.count(kinds[k].first), kinds[k].second));
    ImGui::EndGroup();
    static constexpr const char* meanings[] = {
        "Every term of the criterion held",
        "It does not hold there, as the criterion declares, with the reason",
        "A term did not hold, or a limit is declared where all holds",
        "The solver cannot take the scene, or the case is not for this executor"};
    explain(meanings[k]);
  }
}

void draw_heads(const Columns& columns) {
  // Solvers over their two columns, with a line for each word; below them the precisions.
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const float line = ImGui::GetTextLineHeight();
  const ImU32 faint = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  const auto centred = [&](float x, float width, float y, const std::string& text) {
    list->AddText({std::round(x + 0.5f * (width - ImGui::CalcTextSize(text.c_str()).x)), y}, faint,
                  text.c_str());
  };
  for (const auto& [name, solver, help] : solver_names) {
    const std::size_t cut = name.find('_');
    const std::string first(name.substr(0, cut));
    const float x = columns.left(solver), width = 2 * columns.cell();
    if (cut == name.npos) {
      centred(x, width, at.y + line, first);
    } else {
      centred(x, width, at.y, first);
      centred(x, width, at.y + line, std::string(name.substr(cut + 1)));
    }
    centred(x, columns.cell(), at.y + 2 * line, "f32");
    centred(x + columns.cell(), columns.cell(), at.y + 2 * line, "f64");
  }
  ImGui::Dummy({1, 3 * line});
}

void draw_trial(Workspace& workspace, const HardCasesFacts& facts, std::size_t which, std::size_t k,
                const Columns& columns, const WorkspaceView& view) {
  const HardCaseFacts& one = facts.cases[which];
  const HardTrialFacts& trial = one.trials[k];
  const bool light = workspace.theme == Theme::light;
  const float height = ImGui::GetTextLineHeightWithSpacing();
  const float x = one.refused ? columns.left() + columns.gap() : columns.left(trial);
  const float width = one.refused ? columns.width() - columns.gap() : columns.cell();
  ImGui::SameLine();
  ImGui::SetCursorScreenPos({x, ImGui::GetCursorScreenPos().y});
  ImGui::PushID(static_cast<int>(k));
  const bool clicked = ImGui::InvisibleButton("mark", {width, height - ImGui::GetStyle().ItemSpacing.y});
  ImGui::PopID();
  const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
  ImDrawList* const list = ImGui::GetWindowDrawList();
  const ImVec2 middle{0.5f * (from.x + to.x), 0.5f * (from.y + to.y)};
  if (ImGui::IsItemHovered()) {
    list->AddRectFilled(from, to, ImGui::GetColorU32(ImGuiCol_HeaderHovered), 3);
    trial_tooltip(one, trial, view.with_times, light);
  }
  if (facts.shown == which && facts.shown_trial == k)
    list->AddRect(from, to, ImGui::GetColorU32(ImGuiCol_CheckMark), 3);
  if (one.refused) {  // one answer for all of them
    const float room = 0.8f * columns.size;
    const ImU32 line = ImGui::GetColorU32(ImGuiCol_Border);
    list->AddLine({from.x + 0.4f * columns.size, middle.y}, {middle.x - room, middle.y}, line);
    list->AddLine({middle.x + room, middle.y}, {to.x - 0.4f * columns.size, middle.y}, line);
  }
  draw_hard_mark(middle, columns.size, trial.mark, trial.progress, light);
  track(workspace, ("hard_cases.mark." + one.name + (one.refused ? "" : "." + trial_name(trial))).c_str());
  if (!clicked) return;
  workspace.hard_cases.selected = one.name;
  if (!one.refused && trial.mark != HardMark::not_applicable)
    workspace.hard_cases.open = HardCasesWishes::Opening{which, k};
}

void draw_case(Workspace& workspace, const HardCasesFacts& facts, std::size_t which, const Columns& columns,
               const WorkspaceView& view) {
  const HardCaseFacts& one = facts.cases[which];
  HardCasesWishes& wishes = workspace.hard_cases;
  ImGui::PushID(one.name.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float indent = 0.5f * columns.size, width = columns.left() - at.x;
  if (facts.shown == which)
    ImGui::GetWindowDrawList()->AddRectFilled(at,
                                              {at.x + 0.2f * columns.size, at.y + ImGui::GetTextLineHeight()},
                                              ImGui::GetColorU32(ImGuiCol_CheckMark));
  ImGui::SetCursorScreenPos({at.x + indent, at.y});
  const std::string shown = fitted(one.name, width - indent);
  if (ImGui::Selectable((shown + "###name").c_str(), wishes.selected == one.name, 0, {width - indent, 0})) {
    wishes.selected = one.name;
    if (!one.refused) wishes.open = HardCasesWishes::Opening{which, std::nullopt};
  }
  track(workspace, ("hard_cases.case." + one.name).c_str());
  explain((one.name + ": " + one.what +
           (one.refused ? ". It must be refused on reading" : ". A click opens it from state 0"))
              .c_str());
  for (std::size_t k = 0; k < one.trials.size(); ++k) draw_trial(workspace, facts, which, k, columns, view);
  ImGui::PopID();
}

void draw_list(Workspace& workspace, const HardCasesFacts& facts, const WorkspaceView& view) {
  const float size = ImGui::GetFontSize();
  const Columns columns(ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x -
                        ImGui::GetStyle().ScrollbarSize);
  draw_heads(columns);
  std::size_t groups = 0;
  for (std::size_t k = 0; k < facts.cases.size(); ++k)
    groups += k == 0 || facts.cases[k].group != facts.cases[k - 1].group;
  const float row = ImGui::GetTextLineHeightWithSpacing();
  const float whole = static_cast<float>(facts.cases.size()) * row + static_cast<float>(groups) * 1.4f * row;
  ImGui::BeginChild("list", {0, std::min(whole, 26 * size)}, false, ImGuiWindowFlags_AlwaysVerticalScrollbar);
  for (std::size_t k = 0; k < facts.cases.size(); ++k) {
    if (k == 0 || facts.cases[k].group != facts.cases[k - 1].group) {
      if (k > 0) ImGui::Dummy({1, 0.2f * row});
      faint_text(facts.cases[k].group);
    }
    draw_case(workspace, facts, k, columns, view);
  }
  ImGui::EndChild();
}

void draw_selected(Workspace& workspace, const HardCasesFacts& facts) {
  for (const HardCaseFacts& one : facts.cases)
    if (one.name == workspace.hard_cases.selected) wrapped(one.name + ": " + one.what, true);
  if (facts.before.empty()) return;
  if (ImGui::Button(("back to " + facts.before).c_str())) workspace.hard_cases.back = true;
  track(workspace, "hard_cases.back");
  explain("The scene that was there before, at the state that it was left in");
}

}  // namespace

void draw_hard_cases_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "hard_cases", "Hard cases", workspace.folds.hard_cases)) return end_panel();
  if (view.hard_cases == nullptr || !view.hard_cases->lack.empty()) {
    wrapped(view.hard_cases == nullptr ? "of the next frame" : view.hard_cases->lack, true);
    return end_panel();
  }
  const HardCasesFacts& facts = *view.hard_cases;
  draw_buttons(workspace, facts);
  draw_counts(facts, workspace.theme == Theme::light);
  draw_list(workspace, facts, view);
  draw_selected(workspace, facts);
  end_panel();
}

}  // namespace collidoscope
