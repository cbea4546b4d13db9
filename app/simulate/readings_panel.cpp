#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string>
#include <vector>

#include "app/simulate/panels.h"
#include "app/simulate/widgets.h"
#include <fmt/core.h>
#include <imgui.h>

namespace osteomill::app {

namespace {

constexpr std::size_t kPlotPoints = 200;
// Where the values stand beside their names.
constexpr float kValues_px = 96;

// The greatest of each stretch of ticks: peaks must not fall between two points.
std::vector<float> thinned(const std::deque<TickRecord>& history, double (*magnitude)(const TickRecord&)) {
  std::vector<float> points(kPlotPoints, 0.0f);
  constexpr std::size_t kTicks = 5000;
  for (std::size_t n = 0; n < history.size(); ++n) {
    const std::size_t place = (kTicks - history.size() + n) * kPlotPoints / kTicks;
    points[place] = std::max(points[place], static_cast<float>(magnitude(history[n])));
  }
  return points;
}

void row(const char* name, const std::string& value) {
  ImGui::TextUnformatted(name);
  ImGui::SameLine(ui::px(kValues_px));
  ImGui::TextUnformatted(value.c_str());
}

// The least of 1, 2 and 5 times a power of ten that is not below.
double round_above(double value) {
  double round = std::pow(10.0, std::floor(std::log10(value)));
  for (const double times : {2.0, 2.5, 2.0}) {
    if (round >= value) break;
    round *= times;
  }
  return round;
}

// From 0 to a round number, which stands at the top, over the last 5 s.
void plot(const char* name, const char* unit, const std::deque<TickRecord>& history,
          double (*magnitude)(const TickRecord&), double min_scale, const ImVec4& colour, float height_px) {
  const std::vector<float> points = thinned(history, magnitude);
  const double max = static_cast<double>(*std::max_element(points.begin(), points.end()));
  const double scale = round_above(std::max(max, min_scale));
  const double now = history.empty() ? 0 : magnitude(history.back());
  ImGui::Text("%s  %.2f %s, at most %.2f", name, now, unit, max);
  ui::hint("Now, and the greatest of the last 5 s");
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
  write("0, 5 s ago", 0, 1);
  write("now", 1, 1);
}

// One line, whatever there is to tell, so that nothing below it moves.
void draw_faults(const std::deque<TickRecord>& history) {
  int limited = 0, unknown = 0, unsafe = 0;
  for (const TickRecord& record : history) {
    switch (record.fault) {
      case WrenchFault::none:
      case WrenchFault::eased:
      // The hand moves without the tool, or the device says itself that it gives no pose.
      case WrenchFault::pose_not_finite:
        break;
      case WrenchFault::force_clamped:
      case WrenchFault::torque_clamped:
      case WrenchFault::force_and_torque_clamped:
        ++limited;
        break;
      case WrenchFault::not_finite:
        ++unknown;
        break;
      case WrenchFault::pose_jumped:
      case WrenchFault::tick_late:
        ++unsafe;
        break;
    }
  }
  const int zero = unknown + unsafe;
  const std::string text = zero > 0      ? fmt::format("no force, {} ticks", zero)
                           : limited > 0 ? fmt::format("limited, {} ticks", limited)
                                         : "as computed";
  ImGui::TextUnformatted("hand gets");
  ImGui::SameLine(ui::px(kValues_px));
  ImGui::TextColored(zero + limited > 0 ? ui::kWarning : ImGui::GetStyleColorVec4(ImGuiCol_Text), "%s",
                     text.c_str());
  ui::hint(
      fmt::format(
          "Of the last {} ticks, {} would have been stronger than the limits of force and torque. {} had "
          "none: in {} the hand was moved too fast, or the tick came too late, to be safe, and in {} "
          "there was no number to send.",
          history.size(), limited, zero, unsafe, unknown)
          .c_str());
}

}  // namespace

float draw_readings(ViewState& view, Simulation& simulation, double pictures_per_s, const PixelSize& size) {
  ImGui::SetNextWindowPos({static_cast<float>(size.width) - ui::px(ui::kRightWidth_px + 8), ui::px(8)});
  ImGui::SetNextWindowSize({ui::px(ui::kRightWidth_px), 0});
  ImGui::Begin("Readings", nullptr, ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  const TimingSummary timing = simulation.milling.timing();
  const LiveState& state = simulation.milling.state();
  row("haptic rate", fmt::format("{:.0f} ticks/s", timing.recent_ticks_per_s));
  row("step", fmt::format("{:.0f} us, p99 {:.0f} us", timing.step.p50_us, timing.step.p99_us));
  row("late ticks", fmt::format("{} of {}", timing.late_ticks + timing.missed_ticks, timing.ticks));
  row("pictures", fmt::format("{:.0f} / s", pictures_per_s));
  draw_faults(simulation.history);
  row("removed", fmt::format("{:.2f} mm³", state.record.removed_mm3));
  if (simulation.holder.hardware != nullptr) draw_device(view, *simulation.holder.hardware);
  ImGui::Separator();
  const auto& history = simulation.history;
  // Lower in a low window, where the text needs the room.
  const float height_px = std::min(ui::px(56), 0.07f * static_cast<float>(size.height));
  plot(
      "force", "N", history, [](const TickRecord& r) { return r.wrench.force_N.norm(); }, 1,
      {0.30f, 0.85f, 0.40f, 1}, height_px);
  plot(
      "torque", "N mm", history, [](const TickRecord& r) { return r.wrench.torque_Nmm.norm(); }, 5,
      {0.98f, 0.76f, 0.25f, 1}, height_px);
  if (!simulation.milling.refused_real_time().empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored(ui::kWarning, "%s", simulation.milling.refused_real_time().c_str());
    ImGui::PopTextWrapPos();
  }
  const float below_px = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y + ui::px(8);
  ImGui::End();
  return below_px;
}

}  // namespace osteomill::app
