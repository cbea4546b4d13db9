#include "app/simulate/exercise_panel.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include "app/simulate/panels.h"
#include "app/simulate/theme.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoFocusOnAppearing |
                                    ImGuiWindowFlags_AlwaysAutoResize;

std::string clock_text(double time_s) {
  const auto whole_s = static_cast<int>(std::max(time_s, 0.0));
  return fmt::format("{}:{:02}", whole_s / 60, whole_s % 60);
}

std::string time_text(const Exercise& exercise, double time_s) {
  return exercise.time_s ? fmt::format("{} of {}", clock_text(time_s), clock_text(*exercise.time_s))
                         : clock_text(time_s);
}

void draw_step(const ExerciseWork& work) {
  const Exercise& exercise = work.placed().exercise;
  if (work.step() == 0) return;
  const ExerciseStep& step = exercise.steps[work.step() - 1];
  ImGui::TextWrapped("Step %d of %d: %s", static_cast<int>(work.step()),
                     static_cast<int>(exercise.steps.size()), step.text.c_str());
  const std::string done = fmt::format("{:.0f} of {:.0f} %", work.step_percent(), step.done_percent);
  ImGui::ProgressBar(static_cast<float>(std::min(work.step_percent() / step.done_percent, 1.0)),
                     {-1, 1.2f * ImGui::GetFontSize()}, done.c_str());
}

void draw_distance(const Simulation& simulation, const TickRecord& record) {
  const ExerciseWork& work = *simulation.exercise;
  const auto reading = work.nearest(record.X_WT.position_mm, simulation.milling.setup().tool.burr_radius_mm);
  if (!reading) return;
  const double warn_mm = work.placed().structures[reading->structure].warn_mm;
  const ImVec4 colour = ui::ink(reading->distance_mm <= 0        ? ui::Ink::danger
                                : reading->distance_mm < warn_mm ? ui::Ink::warning
                                                                 : ui::Ink::good);
  ImGui::SetWindowFontScale(1.4f);
  ImGui::TextColored(colour, "%s", distance_text(simulation, record).c_str());
  ImGui::SetWindowFontScale(1);
}

// Draws the burrs allowed by the exercise.
void draw_burrs(ViewState& view, const Exercise& exercise) {
  MillingSetup& setup = view.requested_setup;
  bool is_changed = false, has_own_edge = true;
  for (const AllowedBurr& burr : exercise.burrs) {
    const std::string label = burr.label();
    if (&burr != &exercise.burrs.front()) ui::same_line_if_room(label);
    if (ui::radio((label + "##burr").c_str(), "Fits this burr, one of those allowed in the exercise",
                  burr.is_in(setup))) {
      burr.put_into(setup);
      is_changed = true;
    }
    has_own_edge = has_own_edge && burr.named != nullptr;
  }
  if (exercise.burrs.empty() || !has_own_edge) {
    if (!exercise.burrs.empty()) ui::same_line_if_room("diamond");
    bool diamond = setup.burr == BurrEdge::diamond;
    if (ui::checkbox("diamond##burr",
                     "Uses a diamond burr, which grinds, instead of a toothed one, which cuts", &diamond)) {
      setup.burr = diamond ? BurrEdge::diamond : BurrEdge::cutting;
      is_changed = true;
    }
  }
  view.setup_changed = view.setup_changed || is_changed;
  view.changes += is_changed ? 1 : 0;
}

void draw_switches(ExerciseWork& work) {
  bool guidance = work.has_guidance(), beat = work.has_beat();
  if (ui::checkbox("guidance (G)##exercise",
                   "Shows step, distance and colours; the recording stores when they were shown", &guidance))
    work.show_guidance(guidance);
  if (work.placed().structures.empty()) return;
  ImGui::SameLine();
  if (ui::checkbox(
          "beat (M)##exercise",
          "Plays a beat that quickens as the burr nears a structure; each structure has its own pitch",
          &beat))
    work.play_beat(beat);
}

void take_exercise_keys(ExerciseWork& work) {
  if (ImGui::GetIO().WantTextInput || is_dialogue_open()) return;
  if (ui::is_key_pressed(GLFW_KEY_G)) work.show_guidance(!work.has_guidance());
  if (ui::is_key_pressed(GLFW_KEY_M)) work.play_beat(!work.has_beat());
}

// Places the next window between the two columns.
void place_between_columns(const PixelSize& size, float y_px, float from_below) {
  const float left_px = ui::px(316), right_px = static_cast<float>(size.width) - ui::px(266);
  const float width_px = std::clamp(right_px - left_px - ui::px(8), ui::px(240), ui::px(560));
  ImGui::SetNextWindowPos({0.5f * (left_px + right_px), y_px}, ImGuiCond_Always, {0.5f, from_below});
  ImGui::SetNextWindowSizeConstraints({width_px, 0},
                                      {width_px, static_cast<float>(size.height) - ui::px(16)});
}

void draw_work(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size) {
  ExerciseWork& work = *simulation.exercise;
  const Exercise& exercise = work.placed().exercise;
  const TickRecord& record = simulation.milling.state().record;
  place_between_columns(size, static_cast<float>(size.height) - ui::px(8), 1);
  ImGui::Begin(fmt::format("{}###exercise", exercise.title).c_str(), nullptr, kFixed);
  if (!exercise.task.empty()) ImGui::TextWrapped("%s", exercise.task.c_str());
  draw_burrs(view, exercise);
  if (work.has_guidance()) {
    draw_step(work);
    draw_distance(simulation, record);
  }
  draw_switches(work);
  const double time_s = files.recording_s(simulation).value_or(0);
  const bool is_late = exercise.time_s && time_s > *exercise.time_s;
  ImGui::TextColored(is_late ? ui::ink(ui::Ink::warning) : ImGui::GetStyleColorVec4(ImGuiCol_Text), "%s",
                     time_text(exercise, time_s).c_str());
  ImGui::SameLine();
  if (work.is_measuring()) {
    ImGui::TextUnformatted("Measuring ...");
  } else if (simulation.milling.is_recording()) {
    if (ui::button("Finish", "Ends the recording and shows the results")) view.finish_requested = true;
  } else if (ui::button("Work on", "Continues with this bone in a new recording")) {
    files.begin_recording(view, simulation, "exercise.h5");
  }
  ImGui::End();
}

void draw_row(const MeasuredValue& row) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextWrapped("%s", row.measure.c_str());
  if (!row.source.empty()) ui::tooltip(row.source);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(row.value ? fmt::format("{:.4g} {}", *row.value, row.unit).c_str() : "not measured");
  ImGui::TableNextColumn();
  ImGui::TextWrapped("%s", row.limit.c_str());
  ImGui::TableNextColumn();
  if (row.is_met)
    ImGui::TextColored(ui::ink(*row.is_met ? ui::Ink::good : ui::Ink::warning),
                       *row.is_met ? "met" : "not met");
}

void draw_rows(const char* name, const std::vector<MeasuredValue>& rows, bool limited) {
  if (!ImGui::BeginTable(name, 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH)) return;
  ImGui::TableSetupColumn("measure", ImGuiTableColumnFlags_WidthStretch, 2.2f);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.1f);
  ImGui::TableSetupColumn("limit", ImGuiTableColumnFlags_WidthStretch, 1.1f);
  ImGui::TableSetupColumn("met", ImGuiTableColumnFlags_WidthStretch, 0.7f);
  ImGui::TableHeadersRow();
  for (const MeasuredValue& row : rows)
    if (row.limit.empty() != limited) draw_row(row);
  ImGui::EndTable();
}

void draw_results(ViewState& view, Simulation& simulation, const FilesPanel& files, const PixelSize& size) {
  ExerciseWork& work = *simulation.exercise;
  place_between_columns(size, ui::px(8), 0);
  ImGui::Begin(fmt::format("Results: {}###results", work.placed().exercise.title).c_str(), nullptr, kFixed);
  draw_rows("##items", work.results(), true);
  if (ui::header("All measures", "Shows all measures, including those without a limit", view.open.measures)) {
    ImGui::BeginChild("##all", {0, 0.4f * static_cast<float>(size.height)});
    draw_rows("##measures", work.results(), false);
    ImGui::EndChild();
  }
  ImGui::TextWrapped("%s", (work.folder() / "debrief.html").string().c_str());
  if (ui::button("Open page",
                 "Shows bone, course and every error in the browser; no data leave this computer"))
    view.dialogues.run_reporting_errors([&] { work.open_page(); });
  ui::same_line_if_room("Back to the bone");
  if (ui::button("Back to the bone", "Closes the results and shows the bone as you left it"))
    work.close_results();
  ui::same_line_if_room("Try again");
  if (ui::button("Try again", "Restarts the exercise with the whole bone"))
    view.exercise_requested = work.recorded().file;
  ui::same_line_if_room("Play it back");
  if (ui::button("Play it back", "Plays the recording back; you can continue milling from any moment"))
    view.scan_requested = files.last_recording().string();
  ui::same_line_if_room("Start page");
  if (ui::button("Start page", kStartPageHint)) view.start_page_requested = true;
  ImGui::End();
}

}  // namespace

void finish_exercise(ViewState& view, Simulation& simulation, FilesPanel& files) {
  simulation.milling.set_spindle(false);
  files.end_recording(view, simulation);
  // There is no recording if the disk was full.
  if (!simulation.milling.is_recording() && !files.last_recording().empty())
    simulation.exercise->measure(files.last_recording(), files.name("debrief"));
}

std::string distance_text(const Simulation& simulation, const TickRecord& record) {
  const ExerciseWork& work = *simulation.exercise;
  const auto reading = work.nearest(record.X_WT.position_mm, simulation.milling.setup().tool.burr_radius_mm);
  if (!reading || !work.has_guidance()) return "";
  const std::string& name = work.placed().structures[reading->structure].name;
  return reading->distance_mm <= 0 ? fmt::format("{} touched", name)
                                   : fmt::format("{} {:.1f} mm", name, reading->distance_mm);
}

void draw_exercise(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size) {
  if (!simulation.exercise) return;
  ExerciseWork& work = *simulation.exercise;
  if (const auto sample = work.next_view(view, size, simulation.milling.state().record.time_s))
    simulation.milling.record_view(*sample);
  take_exercise_keys(work);
  if (work.results().empty()) {
    draw_work(view, simulation, files, size);
  } else {
    draw_results(view, simulation, files, size);
  }
  if (!work.is_measuring() && std::exchange(view.finish_requested, false))
    finish_exercise(view, simulation, files);
}

}  // namespace osteomill::app
