// Panel Hard cases: stress scenes by group, with one mark per solver and precision. A click on a name opens
// the scene. A click on a mark opens it with that solver and precision, at the failing state.

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"
#include "ui/test_status.h"
#include "ui/widgets.h"

namespace collidoscope {
namespace {

/// Layout of the marks: two columns per solver, aligned to the right edge.
struct Columns {
  explicit Columns(float right_edge) : size(ImGui::GetFontSize()), right(right_edge) {}
  float cell() const { return 1.75f * size; }
  float gap() const { return 0.55f * size; }
  float width() const { return static_cast<float>(solver_names.size()) * (2 * cell() + gap()); }
  float left() const {
    return right - width();
  }  ///< left end of all columns, including the gap before the first
  float left(Solver solver) const {
    return left() + gap() + static_cast<float>(solver) * (2 * cell() + gap());
  }
  float left(const TestRunView& test_run) const {
    return left(test_run.solver) + (test_run.precision == Precision::f64 ? cell() : 0);
  }

  float size, right;
};

std::string test_run_name(const TestRunView& test_run) {
  return fmt::format("{} {}", name_of(solver_names, test_run.solver),
                     name_of(precision_names, test_run.precision));
}

/// The text, shortened to this width with an ellipsis.
std::string fitted(const std::string& text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  std::string part = text;
  while (!part.empty() && ImGui::CalcTextSize((part + "…").c_str()).x > width) part.pop_back();
  return part + "…";
}

/// `width` in pixels; 0: width of the panel.
void wrapped(const std::string& text, bool faint, float width = 0) {
  ImGui::PushStyleColor(ImGuiCol_Text,
                        ImGui::GetStyleColorVec4(faint ? ImGuiCol_TextDisabled : ImGuiCol_Text));
  ImGui::PushTextWrapPos(width);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

/// A status mark followed by text.
void with_status(TestStatus status, bool light, const std::string& text) {
  const float size = ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  draw_test_status({at.x + 0.5f * size, at.y + 0.5f * size}, size, status, 0, light);
  ImGui::Dummy({size, size});
  ImGui::SameLine();
  ImGui::TextUnformatted(text.c_str());
}

void test_run_tooltip(const HardCaseView& hard_case, const TestRunView& test_run, bool with_times,
                      bool light) {
  const float width = ImGui::GetFontSize() * 30;
  ImGui::BeginTooltip();
  ImGui::TextUnformatted(
      (hard_case.refused ? hard_case.name : hard_case.name + " · " + test_run_name(test_run)).c_str());
  std::string line(name_of(test_status_names, test_run.status));
  if (test_run.status == TestStatus::running)
    line += fmt::format(", {:.0f} %", std::floor(100 * test_run.progress));
  if (test_run.is_finished() && test_run.steps > 0) {
    line += fmt::format(", {} steps", grouped_number(test_run.steps));
    if (with_times) line += fmt::format(" in {:.3g} s", test_run.seconds);
  }
  with_status(test_run.status, light, line);
  if (!test_run.why.empty() && test_run.why != test_run.failure) wrapped(test_run.why, false, width);
  if (test_run.assertions.empty() && !test_run.failure.empty()) wrapped(test_run.failure, false, width);
  if (!test_run.assertions.empty()) ImGui::Separator();
  for (const AssertionView& assertion : test_run.assertions) {
    ImGui::TextUnformatted(assertion.assertion.c_str());
    ImGui::PushStyleColor(ImGuiCol_Text, assertion.passed ? ImGui::GetColorU32(ImGuiCol_TextDisabled)
                                                          : test_status_color(TestStatus::failed, light));
    ImGui::TextUnformatted(fmt::format("    {} {} at state {}{}", assertion.passed ? "worst:" : "fails:",
                                       assertion.value, grouped_number(assertion.state),
                                       assertion.body ? fmt::format(", body {}", *assertion.body) : "")
                               .c_str());
    ImGui::PopStyleColor();
  }
  if (!hard_case.refused && test_run.status != TestStatus::not_applicable)
    faint_text(test_run.failed_state
                   ? fmt::format("Click to open it at state {}", grouped_number(*test_run.failed_state))
                   : "Click to open it at state 0");
  ImGui::EndTooltip();
}

void draw_buttons(Workspace& workspace, const HardCasesView& panel) {
  const float size = ImGui::GetFontSize();
  HardCasesRequests& requests = workspace.hard_cases;
  std::int64_t all = 0, is_finished = 0;
  for (const HardCaseView& hard_case : panel.cases) {
    all += std::ssize(hard_case.test_runs);
    is_finished += std::ranges::count_if(hard_case.test_runs, &TestRunView::is_finished);
  }
  const bool running = !panel.current_task.empty() || panel.opening;
  const double share =
      panel.opening ? *panel.opening
                    : static_cast<double>(is_finished) / static_cast<double>(std::max<std::int64_t>(all, 1));
  const std::string text = panel.opening ? fmt::format("opening: {:.0f} %", std::floor(100 * share))
                                         : fmt::format("{} of {} test runs", is_finished, all);
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
  ImGui::ProgressBar(static_cast<float>(share), {ImGui::GetContentRegionAvail().x - 12.6f * size, 0},
                     text.c_str());
  ImGui::PopStyleColor();
  explain(fmt::format("{}; on {}", panel.current_task.empty() ? "idle" : panel.current_task, panel.executor)
              .c_str());
  ImGui::SameLine();
  const char* const label = running             ? "stop"
                            : is_finished == 0  ? "run all"
                            : is_finished < all ? "resume"
                                                : "run again";
  if (ImGui::Button(label, {5.4f * size, 0})) (running ? requests.stop : requests.run_all) = true;
  track(workspace, "hard_cases.run_all");
  explain("Runs all cases with each solver and precision, a slice per frame. The scene continues meanwhile");
  ImGui::SameLine();
  const bool any = std::ranges::any_of(
      panel.cases, [&](const auto& hard_case) { return hard_case.name == requests.selected; });
  ImGui::BeginDisabled(!any);
  if (ImGui::Button("run selected", {-1, 0})) requests.run_selected = true;
  ImGui::EndDisabled();
  track(workspace, "hard_cases.run");
  if (any) explain(("Runs " + requests.selected + " with each solver and precision").c_str());
}

/// Number of test runs by status; also the legend of the marks.
void draw_counts(const HardCasesView& panel, bool light) {
  constexpr std::pair<TestStatus, const char*> kinds[] = {{TestStatus::passed, "passed"},
                                                          {TestStatus::expected_failure, "limit"},
                                                          {TestStatus::failed, "failed"},
                                                          {TestStatus::not_applicable, "n/a"}};
  const float width = ImGui::GetContentRegionAvail().x / 4, left = ImGui::GetCursorPosX();
  for (int k = 0; k < 4; ++k) {
    if (k > 0) ImGui::SameLine(left + static_cast<float>(k) * width);
    ImGui::BeginGroup();
    with_status(kinds[k].first, light, fmt::format("{} {}", panel.count(kinds[k].first), kinds[k].second));
    ImGui::EndGroup();
    static constexpr const char* meanings[] = {"All terms of the criterion hold",
                                               "A term fails, as the criterion declares, with the reason",
                                               "A term fails, or a limit is declared although all terms hold",
                                               "The solver or the executor does not support this case"};
    explain(meanings[k]);
  }
}

void draw_heads(const Columns& columns) {
  // Solver names over two columns each, one word per line. Precisions below.
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

void draw_test_run(Workspace& workspace, const HardCasesView& panel, std::size_t which, std::size_t k,
                   const Columns& columns, const WorkspaceView& view) {
  const HardCaseView& hard_case = panel.cases[which];
  const TestRunView& test_run = hard_case.test_runs[k];
  const bool light = workspace.theme == Theme::light;
  const float height = ImGui::GetTextLineHeightWithSpacing();
  const float x = hard_case.refused ? columns.left() + columns.gap() : columns.left(test_run);
  const float width = hard_case.refused ? columns.width() - columns.gap() : columns.cell();
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
    test_run_tooltip(hard_case, test_run, view.with_times, light);
  }
  if (panel.shown == which && panel.shown_test_run == k)
    list->AddRect(from, to, ImGui::GetColorU32(ImGuiCol_CheckMark), 3);
  if (hard_case.refused) {  // one result for all solvers
    const float room = 0.8f * columns.size;
    const ImU32 line = ImGui::GetColorU32(ImGuiCol_Border);
    list->AddLine({from.x + 0.4f * columns.size, middle.y}, {middle.x - room, middle.y}, line);
    list->AddLine({middle.x + room, middle.y}, {to.x - 0.4f * columns.size, middle.y}, line);
  }
  draw_test_status(middle, columns.size, test_run.status, test_run.progress, light);
  track(workspace,
        ("hard_cases.mark." + hard_case.name + (hard_case.refused ? "" : "." + test_run_name(test_run)))
            .c_str());
  if (!clicked) return;
  workspace.hard_cases.selected = hard_case.name;
  if (!hard_case.refused && test_run.status != TestStatus::not_applicable)
    workspace.hard_cases.open = HardCasesRequests::Opening{which, k};
}

void draw_case(Workspace& workspace, const HardCasesView& panel, std::size_t which, const Columns& columns,
               const WorkspaceView& view) {
  const HardCaseView& hard_case = panel.cases[which];
  HardCasesRequests& requests = workspace.hard_cases;
  ImGui::PushID(hard_case.name.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float indent = 0.5f * columns.size, width = columns.left() - at.x;
  if (panel.shown == which)
    ImGui::GetWindowDrawList()->AddRectFilled(at,
                                              {at.x + 0.2f * columns.size, at.y + ImGui::GetTextLineHeight()},
                                              ImGui::GetColorU32(ImGuiCol_CheckMark));
  ImGui::SetCursorScreenPos({at.x + indent, at.y});
  const std::string shown = fitted(hard_case.name, width - indent);
  if (ImGui::Selectable((shown + "###name").c_str(), requests.selected == hard_case.name, 0,
                        {width - indent, 0})) {
    requests.selected = hard_case.name;
    if (!hard_case.refused) requests.open = HardCasesRequests::Opening{which, std::nullopt};
  }
  track(workspace, ("hard_cases.case." + hard_case.name).c_str());
  explain((hard_case.name + ": " + hard_case.what +
           (hard_case.refused ? ". The reader must reject it" : ". Click to open it at state 0"))
              .c_str());
  for (std::size_t k = 0; k < hard_case.test_runs.size(); ++k)
    draw_test_run(workspace, panel, which, k, columns, view);
  ImGui::PopID();
}

void draw_list(Workspace& workspace, const HardCasesView& panel, const WorkspaceView& view) {
  const float size = ImGui::GetFontSize();
  const Columns columns(ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x -
                        ImGui::GetStyle().ScrollbarSize);
  draw_heads(columns);
  std::size_t groups = 0;
  for (std::size_t k = 0; k < panel.cases.size(); ++k)
    groups += k == 0 || panel.cases[k].group != panel.cases[k - 1].group;
  const float row = ImGui::GetTextLineHeightWithSpacing();
  const float whole = static_cast<float>(panel.cases.size()) * row + static_cast<float>(groups) * 1.4f * row;
  ImGui::BeginChild("list", {0, std::min(whole, 26 * size)}, false, ImGuiWindowFlags_AlwaysVerticalScrollbar);
  for (std::size_t k = 0; k < panel.cases.size(); ++k) {
    if (k == 0 || panel.cases[k].group != panel.cases[k - 1].group) {
      if (k > 0) ImGui::Dummy({1, 0.2f * row});
      faint_text(panel.cases[k].group);
    }
    draw_case(workspace, panel, k, columns, view);
  }
  ImGui::EndChild();
}

void draw_selected(Workspace& workspace, const HardCasesView& panel) {
  for (const HardCaseView& hard_case : panel.cases)
    if (hard_case.name == workspace.hard_cases.selected)
      wrapped(hard_case.name + ": " + hard_case.what, true);
  if (panel.scene_before.empty()) return;
  if (ImGui::Button(("back to " + panel.scene_before).c_str())) workspace.hard_cases.back = true;
  track(workspace, "hard_cases.back");
  explain("Returns to the previous scene, at its last state");
}

}  // namespace

void draw_hard_cases_panel(Workspace& workspace, const WorkspaceView& view) {
  if (!begin_panel(workspace, "hard_cases", "Hard cases", workspace.visible_panels.hard_cases))
    return end_panel();
  if (view.hard_cases == nullptr || !view.hard_cases->unavailable_reason.empty()) {
    wrapped(
        view.hard_cases == nullptr ? "available after the next frame" : view.hard_cases->unavailable_reason,
        true);
    return end_panel();
  }
  const HardCasesView& panel = *view.hard_cases;
  draw_buttons(workspace, panel);
  draw_counts(panel, workspace.theme == Theme::light);
  draw_list(workspace, panel, view);
  draw_selected(workspace, panel);
  end_panel();
}

}  // namespace collidoscope
