#include <algorithm>
#include <cfloat>
#include <cmath>

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include "osteomill/base/round_numbers.h"

#include "app/simulate/panels.h"
#include "app/simulate/theme.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr ImGuiWindowFlags kFixed =
    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse;
constexpr ImU32 kCut = IM_COL32(90, 170, 255, 255), kContact = IM_COL32(110, 200, 120, 255),
                kNoGo = IM_COL32(255, 80, 70, 255), kFault = IM_COL32(255, 184, 64, 255),
                kCursor = IM_COL32(255, 255, 255, 220);

// Maps an interval of time to an interval of pixels.
struct TimeAxis {
  float left_px, right_px;
  double begin_s, end_s;

  float at(double time_s) const {
    const double share = end_s > begin_s ? (time_s - begin_s) / (end_s - begin_s) : 0;
    return left_px + static_cast<float>(std::clamp(share, 0.0, 1.0)) * (right_px - left_px);
  }
};

void draw_cursor(const TimeAxis& axis, double time_s, float top_px, float bottom_px) {
  const float x = axis.at(time_s);
  ImGui::GetWindowDrawList()->AddLine({x, top_px}, {x, bottom_px}, kCursor, ui::px(1.5f));
}

void draw_spans(const TimeAxis& axis, const char* name, const PlaybackMarks::Spans& spans, ImU32 colour,
                const std::string& tip = {}) {
  const float height_px = ImGui::GetTextLineHeight();
  const ImVec2 place = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled({axis.left_px, place.y + 2}, {axis.right_px, place.y + height_px - 2},
                     ImGui::GetColorU32(ImGuiCol_FrameBg));
  for (const auto& [from_s, to_s] : spans)
    list.AddRectFilled({axis.at(from_s), place.y + 2},
                       {std::max(axis.at(to_s), axis.at(from_s) + 2), place.y + height_px - 2}, colour);
  ImGui::TextUnformatted(name);
  if (!tip.empty() && ImGui::IsMouseHoveringRect({place.x, place.y}, {axis.right_px, place.y + height_px}))
    ImGui::SetTooltip("%s", tip.c_str());
}

void draw_steps(const TimeAxis& axis, const PlaybackMarks& marks) {
  const ImVec2 place = ImGui::GetCursorScreenPos();
  const float height_px = ImGui::GetTextLineHeight();
  ImGui::TextUnformatted("steps");
  for (const auto& [time_s, text] : marks.steps) {
    const float x = axis.at(time_s), half = ui::px(4);
    ImGui::GetWindowDrawList()->AddTriangleFilled({x - half, place.y + 2}, {x + half, place.y + 2},
                                                  {x, place.y + height_px - 2},
                                                  ImGui::GetColorU32(ImGuiCol_Text));
    if (ImGui::IsMouseHoveringRect({x - half, place.y}, {x + half, place.y + height_px}))
      ImGui::SetTooltip("%s, from %.3f s", text.c_str(), time_s);
  }
}

// Draws the time line of the whole recording: its marks, and a slider for seeking.
void draw_time_line(Playback& playback) {
  const float names_px = ui::px(64), from_px = ImGui::GetCursorScreenPos().x + names_px;
  const float width_px = ImGui::GetContentRegionAvail().x - names_px;
  auto time_s = static_cast<float>(playback.record().time_s);
  ImGui::SetCursorScreenPos({from_px, ImGui::GetCursorScreenPos().y});
  ImGui::PushItemWidth(width_px);
  if (ui::slider("##time", "Goes to a time of the recording. Drag, or Ctrl+click to type a time", &time_s,
                 static_cast<float>(playback.begin_s()), static_cast<float>(playback.end_s()), "%.3f s",
                 ImGuiSliderFlags_AlwaysClamp)) {
    playback.play(false);
    playback.go_to_time(static_cast<double>(time_s));
  }
  ImGui::PopItemWidth();
  // The ends of the slider's range are half its grip inside.
  const float inside_px = 0.5f * ImGui::GetStyle().GrabMinSize + 2;
  const TimeAxis axis{from_px + inside_px, from_px + width_px - inside_px, playback.begin_s(),
                      playback.end_s()};
  const float top_px = ImGui::GetCursorScreenPos().y;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ui::px(8), 0});
  const PlaybackMarks& marks = playback.marks();
  draw_spans(axis, "cut", marks.cuts, kCut);
  draw_spans(axis, "contact", marks.contacts, kContact);
  draw_spans(axis, "no-go", marks.no_go, kNoGo);
  for (const auto& [structure, spans] : marks.guards)
    draw_spans(axis, "guard", spans, kContact, "Held off " + structure);
  draw_spans(axis, "fault", marks.faults, kFault);
  draw_steps(axis, marks);
  ImGui::PopStyleVar();
  draw_cursor(axis, playback.record().time_s, top_px, ImGui::GetCursorScreenPos().y);
  ImGui::Dummy({0, ui::px(1)});
}

// Plots a few seconds around the current tick, from 0 to a round maximum.
void draw_plot(const Playback& playback, const char* name, const char* unit,
               double (*magnitude)(const TickRecord&), double min_scale, const ImVec4& colour,
               float width_px) {
  constexpr double kAround_s = 5;
  const std::vector<TickRecord>& records = playback.recording().records;
  const double now_s = playback.record().time_s;
  const ImVec2 place = ImGui::GetCursorScreenPos();
  const float height_px = ui::px(46);
  const TimeAxis axis{place.x, place.x + width_px, now_s - kAround_s, now_s + kAround_s};
  const auto first = std::ranges::lower_bound(records, axis.begin_s, {}, &TickRecord::time_s);
  const auto last = std::ranges::upper_bound(records, axis.end_s, {}, &TickRecord::time_s);
  // Maximum of the ticks of each pixel.
  std::vector<ImVec2> line;
  double scale = min_scale;
  for (auto record = first; record != last; ++record) {
    const float x = std::floor(axis.at(record->time_s)), value = static_cast<float>(magnitude(*record));
    if (line.empty() || line.back().x != x) line.emplace_back(x, 0.0f);
    line.back().y = std::max(line.back().y, value);
    scale = std::max(scale, static_cast<double>(value));
  }
  scale = round_up(scale);
  for (ImVec2& point : line) point.y = place.y + height_px * (1 - point.y / static_cast<float>(scale));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(place, {place.x + width_px, place.y + height_px}, ImGui::GetColorU32(ImGuiCol_FrameBg));
  list.AddPolyline(line.data(), static_cast<int>(line.size()), ImGui::GetColorU32(colour), 0, 1);
  draw_cursor(axis, now_s, place.y, place.y + height_px);
  const std::string text = fmt::format("{} {:.2f} {}; full scale {:g}, ±{:g} s", name,
                                       magnitude(playback.record()), unit, scale, kAround_s);
  list.AddText(ImGui::GetFont(), 0.85f * ImGui::GetFontSize(), {place.x + ui::px(4), place.y + 1},
               ImGui::GetColorU32(ImGuiCol_Text, 0.8f), text.c_str());
  ImGui::Dummy({width_px, height_px});
}

void draw_buttons(Playback& playback) {
  if (ui::button(playback.is_playing() ? "Pause##play" : "Play##play",
                 "Plays or pauses the recording (Space)"))
    playback.play(!playback.is_playing());
  for (const auto& [label, by] : {std::pair{"< tick", -1}, {"tick >", 1}}) {
    ImGui::SameLine();
    if (!ui::button(label, by < 0 ? "Goes one tick back" : "Goes one tick forward")) continue;
    playback.play(false);
    playback.go_to_tick(static_cast<std::size_t>(
        std::max<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(playback.tick()) + by, 0)));
  }
  for (const auto& [label, speed] : {std::pair{"0.1x", 0.1}, {"1x", 1.0}, {"4x", 4.0}, {"16x", 16.0}}) {
    ImGui::SameLine();
    if (ui::radio(label, fmt::format("Plays at {:g} times the recorded speed", speed),
                  playback.speed() == speed))
      playback.set_speed(speed);
  }
  ImGui::SameLine();
  bool follows = playback.is_following_recorded_view();
  ImGui::BeginDisabled(playback.view() == nullptr);
  if (ui::checkbox("recorded camera", "Shows the trainee's view. To look around freely, drag the picture",
                   &follows))
    playback.follow_recorded_view(follows);
  ImGui::EndDisabled();
}

void row(const char* name, const std::string& value) {
  ImGui::TextUnformatted(name);
  ImGui::SameLine(ui::px(90));
  ImGui::TextWrapped("%s", value.c_str());
}

void draw_facts(const Playback& playback) {
  const TickRecord& record = playback.record();
  const LoadedRecording& work = playback.work();
  row("recording", work.recording.path.filename().string());
  row("scan", work.bone.name);
  if (work.exercise) row("exercise", work.exercise->title);
  if (const auto from = branch_point(work.recording.description))
    row("continues", fmt::format("{} at {:.3f} s", from->recording, from->time_s));
  row("time", fmt::format("{:.3f} s, tick {} of {}", record.time_s, playback.tick() + 1,
                          work.recording.records.size()));
  row("burr", fmt::format("{:g} mm, {:.0f} rpm", 2 * playback.run().tool.burr_radius_mm,
                          std::max(record.spindle_rpm, 0.0)));
  row("algorithm", playback.run().algorithm.name);
  row("removed", fmt::format("{:.2f} mm³", record.removed_mm3));
  if (record.no_go_distance_mm < 100) row("no-go", fmt::format("{:.2f} mm away", record.no_go_distance_mm));
  if (const ViewSample* view = playback.view(); view != nullptr && view->step > 0)
    row("step", std::to_string(view->step));
  row("output", record.fault == WrenchFault::none ? "as computed" : std::string(name_of(record.fault)));
  ImGui::TextWrapped("%s", playback.verdict().c_str());
}

void take_keys(Playback& playback, ViewState& view) {
  if (ImGui::GetIO().WantTextInput || is_dialogue_open()) return;
  if (ui::is_key_pressed(GLFW_KEY_SPACE)) playback.play(!playback.is_playing());
  if (ui::is_key_pressed(GLFW_KEY_F11)) view.full_screen_requested = true;
}

}  // namespace

void draw_playback(ViewState& view, Playback& playback, const PixelSize& size) {
  take_keys(playback, view);
  ImGui::SetNextWindowPos({ui::px(8), ui::px(8)});
  ImGui::SetNextWindowSize({ui::px(300), 0});
  ImGui::Begin("Playback", nullptr, kFixed);
  if (ui::button(
          "Again from here",
          "Continues milling from this tick, with its bone, tool, settings and time, in a new recording")) {
    playback.play(false);
    view.branch_requested = BranchOptions{playback.recording().path.string(), playback.record().time_s};
  }
  ImGui::SameLine();
  if (ui::button("Whole", kWholeHint)) view.camera = fit_bone(view.camera, view.box, size);
  ImGui::SameLine();
  if (ui::button("Start page", kStartPageHint)) view.start_page_requested = true;
  ui::checkbox("ghost", kGhostHint, &view.ghost);
  ImGui::SameLine();
  ui::checkbox("arrows", kArrowsHint, &view.arrows);
  ImGui::SameLine();
  ui::checkbox("see through", kSeeThroughHint, &view.see_through);
  draw_facts(playback);
  ImGui::End();
  const float width_px = static_cast<float>(size.width) - ui::px(16);
  ImGui::SetNextWindowPos({ui::px(8), static_cast<float>(size.height) - ui::px(8)}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSize({width_px, 0});
  ImGui::Begin("##time line", nullptr, kFixed | ImGuiWindowFlags_NoTitleBar);
  draw_buttons(playback);
  draw_time_line(playback);
  const float plot_px = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  draw_plot(
      playback, "force", "N", [](const TickRecord& r) { return r.wrench.force_N.norm(); }, 1,
      ui::ink(ui::Ink::force), plot_px);
  ImGui::SameLine();
  draw_plot(
      playback, "torque", "N mm", [](const TickRecord& r) { return r.wrench.torque_Nmm.norm(); }, 5,
      ui::ink(ui::Ink::torque), plot_px);
  ImGui::End();
}

}  // namespace osteomill::app
