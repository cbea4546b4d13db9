#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <imgui.h>

#include "osteomill/base/round_numbers.h"
#include "osteomill/session/workspace.h"

#include "app/simulate/panels.h"
#include "app/simulate/theme.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr std::size_t kPlotPoints = 200;
// Column of the values next to their names, px.
constexpr float kValues_px = 96;
// Wide enough for "10000 poses/s", so that the button next to the rate does not move with the number of
// digits.
constexpr float kCalibrate_px = 112;

// Returns the maximum of each group of ticks, so that no peak falls between two points.
std::vector<float> downsampled(const std::deque<TickRecord>& history, std::size_t ticks,
                               double (*magnitude)(const TickRecord&)) {
  std::vector<float> points(kPlotPoints, 0.0f);
  for (std::size_t n = 0; n < history.size(); ++n) {
    const std::size_t place = (ticks - history.size() + n) * kPlotPoints / ticks;
    points[place] = std::max(points[place], static_cast<float>(magnitude(history[n])));
  }
  return points;
}

void row(const char* name, const std::string& value,
         const ImVec4& colour = ImGui::GetStyleColorVec4(ImGuiCol_Text)) {
  ImGui::TextUnformatted(name);
  ImGui::SameLine(ui::px(kValues_px));
  ImGui::TextColored(colour, "%s", value.c_str());
}

// Plots the last 5 s from 0 to a round maximum, labelled at the top.
void plot(const char* name, const char* unit, const Simulation& simulation,
          double (*magnitude)(const TickRecord&), double min_scale, const ImVec4& colour, float height_px) {
  const std::deque<TickRecord>& history = simulation.history;
  const std::vector<float> points = downsampled(history, simulation.max_history(), magnitude);
  const double max = static_cast<double>(*std::max_element(points.begin(), points.end()));
  const double scale = round_up(std::max(max, min_scale));
  const double now = history.empty() ? 0 : magnitude(history.back());
  ImGui::Text("%s  %.2f %s, max %.2f", name, now, unit, max);
  ui::tooltip("Present value, and maximum of the last 5 s");
  const ImVec2 place = ImGui::GetCursorScreenPos();
  const float width_px = ImGui::GetContentRegionAvail().x;
  ImGui::Dummy({width_px, height_px});
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(place, {place.x + width_px, place.y + height_px}, ImGui::GetColorU32(ImGuiCol_FrameBg));
  std::vector<ImVec2> line;
  for (std::size_t n = 0; n < points.size(); ++n) {
    line.emplace_back(place.x + width_px * static_cast<float>(n) / (kPlotPoints - 1),
                      place.y + height_px * (1 - points[n] / static_cast<float>(scale)));
  }
  list.AddPolyline(line.data(), static_cast<int>(line.size()), ImGui::GetColorU32(colour), 0, 1);
  const ImU32 grey = ImGui::GetColorU32(ImGuiCol_Text, 0.65f);
  const float small_px = 0.85f * ImGui::GetFontSize();
  const auto write = [&](const std::string& text, float right, float down) {
    const ImVec2 text_px = ImGui::GetFont()->CalcTextSizeA(small_px, FLT_MAX, 0, text.c_str());
    const ImVec2 at(place.x + ui::px(4) + right * (width_px - text_px.x - ui::px(8)),
                    place.y + ui::px(1) + down * (height_px - text_px.y - ui::px(2)));
    list.AddText(ImGui::GetFont(), small_px, at, grey, text.c_str());
  };
  write(fmt::format("{:g} {}", scale, unit), 0, 0);
  write("5 s ago", 0, 1);
  write("now", 1, 1);
}

// Always draws one line, so that nothing below it moves.
void draw_faults(const std::deque<TickRecord>& history) {
  FaultCount faults;
  for (const TickRecord& record : history) faults.add(record);
  const int limited = faults.limited();
  // Excludes ticks without a pose: a clutch is held, or the device's own line reports it.
  const int zero = faults.not_finite() + faults.unsafe();
  const bool held_back = !history.empty() && history.back().fault == WrenchFault::held_back;
  const std::string text = held_back     ? "off: lift the tool out"
                           : zero > 0    ? fmt::format("no force, {} ticks", zero)
                           : limited > 0 ? fmt::format("limited, {} ticks", limited)
                                         : "as computed";
  row("output", text,
      held_back || zero + limited > 0 ? ui::ink(ui::Ink::warning) : ImGui::GetStyleColorVec4(ImGuiCol_Text));
  ui::tooltip(fmt::format(
      "Of the last {} ticks, {} were limited in force or torque. {} had no force: in {} the hand moved too "
      "fast or the tick came too late to be safe, and in {} the result was not a number. {} more had no "
      "force because the tool was in bone when the device was engaged and must first leave it.",
      history.size(), limited, zero, faults.unsafe(), faults.not_finite(), faults.held_back()));
}

using Step = ViewState::Calibration::Step;

void save_device_turn(ViewState& view, ConnectedDevice& device, const Vec3& up_B_mm) {
  const DeviceCapabilities& can = device.capabilities();
  const auto turn_deg = turn_by_moves_deg(can, view.calibration.right_B_mm, up_B_mm);
  if (!turn_deg) {
    view.dialogues.add_error(
        "The two moves were shorter than 10 mm, or in the same direction. The calibration was not changed.");
    return;
  }
  WorkspaceSettings settings = device.workspace();
  settings.turn_V_deg = *turn_deg;
  device.set_workspace(settings);
  const std::filesystem::path path = workspace_path(can.name);
  view.dialogues.run_reporting_errors([&] {
    if (path.empty()) {
      view.message =
          "The device's orientation is set until the window closes: there is no folder to save it in";
      return;
    }
    save_workspace(path, settings);
    view.message = "Saved the device's orientation in " + path.string();
  });
}

void draw_calibration(ViewState& view, ConnectedDevice& device, const Vec3& handle_B_mm) {
  ViewState::Calibration& calibration = view.calibration;
  if (calibration.step == Step::none) {
    ImGui::SameLine(ui::px(kCalibrate_px));
    if (ui::button(
            "Calibrate",
            "Calibrates the device's orientation by two moves of your hand; the tool stays still meanwhile"))
      calibration = {Step::right, handle_B_mm, Vec3::Zero()};
    return;
  }
  const bool to_the_right = calibration.step == Step::right;
  ImGui::TextWrapped("%s", to_the_right ? "Move your hand a few centimetres to the right, then press"
                                        : "Now move it a few centimetres up, then press");
  const bool moved = ui::button(to_the_right ? "That was right" : "That was up",
                                "Uses the motion of your hand since the last press");
  ImGui::SameLine();
  if (ui::button("Cancel##calibration", "Ends the calibration without changing it")) {
    calibration = {};
  } else if (moved && to_the_right) {
    calibration = {Step::up, handle_B_mm, handle_B_mm - calibration.from_B_mm};
  } else if (moved) {
    save_device_turn(view, device, handle_B_mm - calibration.from_B_mm);
    calibration = {};
  }
}

// Draws a device fault and reserves its space afterwards, so that the controls below do not move.
void draw_device_fault(const std::string& complaint) {
  float& room_px = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("complaint"));
  const float from_px = ImGui::GetCursorPosY();
  if (!complaint.empty()) ui::warning("The device " + complaint);
  room_px = std::max(room_px, ImGui::GetCursorPosY() - from_px);
  ImGui::SetCursorPosY(from_px);
  if (room_px > 0) ImGui::Dummy({0, room_px - ImGui::GetStyle().ItemSpacing.y});
}

// Draws the state of the device and the calibration of its orientation.
void draw_device(ViewState& view, ConnectedDevice& device) {
  ImGui::Separator();
  const DeviceReport report = device.report();
  ImGui::TextWrapped("%s", device.capabilities().name.c_str());
  ImGui::TextDisabled("%.0f poses/s", report.inputs_per_s);
  draw_calibration(view, device, report.handle_B_mm);
  draw_device_fault(report.complaint());
}

// Maximum number of rows shown; longer lists scroll.
constexpr float kMaxRows = 12;
constexpr float kMinRows = 2;
// Height of the help below the rows, and of title and checkbox above them, at the usual text size.
constexpr float kHelp_px = 110;
constexpr float kHead_px = 62;

ImU32 colour_of(const Label& label) {
  return IM_COL32(label.colour[0], label.colour[1], label.colour[2], 255);
}

void draw_row(const Simulation& simulation, std::size_t n) {
  const Label& label = simulation.label_count.labels()[n];
  const float side = ImGui::GetTextLineHeight();
  const ImVec2 place = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddRectFilled(place, {place.x + side, place.y + side}, colour_of(label), 2);
  ImGui::Dummy({side, side});
  ImGui::SameLine();
  const ImVec4 text = label.no_go ? ui::ink(ui::Ink::danger) : ImGui::GetStyleColorVec4(ImGuiCol_Text);
  // Next to the volume, wrapped if the name is long.
  ImGui::PushTextWrapPos(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(" 0000.00 mm³").x);
  ImGui::TextColored(text, "%s%s", label.name.c_str(), label.no_go ? " (no-go)" : "");
  ImGui::PopTextWrapPos();
  const LabelCount::Entry& entry = simulation.label_count.entries()[n];
  if (entry.contacts > 0) {
    ui::tooltip(fmt::format(
        "The burr touched it for {:.1f} s, first at {:.1f} s, with {:.2f} N on average and {:.2f} N at "
        "most",
        entry.time_s, entry.first_s, entry.force_mean_N, entry.force_max_N));
  }
  const std::vector<double>& removed_mm3 = simulation.removed_by_label_mm3;
  if (n + 1 >= removed_mm3.size() || (entry.contacts == 0 && removed_mm3[n + 1] == 0)) return;
  const std::string removed = fmt::format("{:.2f} mm³", removed_mm3[n + 1]);
  ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(removed.c_str()).x);
  ImGui::TextUnformatted(removed.c_str());
}

}  // namespace

// Draws how well the haptic thread keeps time.
static void draw_timing(const Simulation& simulation, double frames_per_s) {
  const TimingSummary timing = simulation.milling.timing();
  row("haptic rate", fmt::format("{:.0f} ticks/s", timing.recent_ticks_per_s));
  row("step", fmt::format("{:.0f} us, p99 {:.0f} us", timing.step.p50_us, timing.step.p99_us));
  ui::tooltip("Time to compute the force of one tick: median and 99th percentile");
  row("late ticks", fmt::format("{} of {}", timing.late_ticks + timing.missed_ticks, timing.ticks));
  row("pictures", fmt::format("{:.0f} / s", frames_per_s));
}

static void draw_plots(const Simulation& simulation, const PixelSize& size) {
  ImGui::Separator();
  // Lower in a low window, to leave space for the text.
  const float height_px = std::min(ui::px(56), 0.07f * static_cast<float>(size.height));
  plot(
      "force", "N", simulation, [](const TickRecord& r) { return r.wrench.force_N.norm(); }, 1,
      ui::ink(ui::Ink::force), height_px);
  plot(
      "torque", "N mm", simulation, [](const TickRecord& r) { return r.wrench.torque_Nmm.norm(); }, 5,
      ui::ink(ui::Ink::torque), height_px);
}

float draw_readings(ViewState& view, Simulation& simulation, double frames_per_s, const PixelSize& size) {
  ui::begin_side_panel("Readings", ui::px(8), &view.open.readings);
  const TickRecord& record = simulation.milling.state().record;
  if (view.open.laboratory) {
    draw_timing(simulation, frames_per_s);
  } else {
    row("force", fmt::format("{:.2f} N", record.wrench.force_N.norm()));
    ui::tooltip("Magnitude of the force on your hand");
  }
  draw_faults(simulation.history);
  row("removed", fmt::format("{:.2f} mm³", record.removed_mm3));
  ui::tooltip(
      "Removed volume, weighted by density: bone half as dense as usual in this scan counts half. The "
      "results of an exercise count removed voxels instead");
  const double set_rpm = simulation.milling.setup().cutting.spindle_speed_rpm;
  row("spindle", fmt::format("{:.0f} of {:.0f} rpm", std::max(record.spindle_rpm, 0.0), set_rpm));
  ui::tooltip("Present and set speed of the spindle");
  if (simulation.tool_source.hardware != nullptr) draw_device(view, *simulation.tool_source.hardware);
  if (view.open.laboratory) draw_plots(simulation, size);
  if (const std::string& refused = simulation.milling.refused_real_time(); !refused.empty()) {
    ui::warning("no real-time priority");
    ui::tooltip(refused);
  }
  return ui::end_side_panel();
}

float draw_labels(ViewState& view, const Simulation& simulation, const VerticalSpan& span) {
  const std::size_t count = simulation.label_count.labels().size();
  if (count == 0) return span.top_px;
  const float line_px = ImGui::GetTextLineHeightWithSpacing();
  const float rows_px = span.bottom_px - span.top_px - ui::px(kHead_px) - (view.help ? ui::px(kHelp_px) : 0);
  const float rows = std::floor(std::min({static_cast<float>(count), kMaxRows, rows_px / line_px}));
  // They fit once help, the message or the readings are closed.
  if (rows < std::min(kMinRows, static_cast<float>(count))) return span.top_px;
  ui::begin_side_panel("Labels", span.top_px, nullptr, ImGuiWindowFlags_NoFocusOnAppearing);
  ui::checkbox(
      "label colours",
      "Shows the bone in the colours of its label map. The list shows the removed volume of each label",
      &view.labels);
  ImGui::BeginChild("##labels", {0, rows * line_px});
  for (std::size_t n = 0; n < count; ++n) draw_row(simulation, n);
  ImGui::EndChild();
  return ui::end_side_panel();
}

void draw_no_go(Simulation& simulation) {
  constexpr double kShown_s = 4;
  const double now_s = simulation.milling.state().record.time_s;
  const auto last_s = simulation.label_count.last_no_go_s();
  if (!last_s || now_s - *last_s > kShown_s) return;
  const float margin_px = 0.7f * ImGui::GetTextLineHeight();
  ui::badge(simulation.no_go_text, ui::px(48), margin_px, IM_COL32(190, 25, 25, 245), false);
}

}  // namespace osteomill::app
