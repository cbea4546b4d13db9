#include <algorithm>
#include <string>
#include <vector>

#include "app/simulate/panels.h"
#include "app/simulate/widgets.h"
#include <fmt/core.h>
#include <imgui.h>

namespace osteomill::app {

namespace {

constexpr std::size_t kPlotPoints = 200;

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
  ImGui::SameLine(ui::px(96));
  ImGui::TextUnformatted(value.c_str());
}

void plot(const char* name, const char* unit, const std::deque<TickRecord>& history,
          double (*magnitude)(const TickRecord&), float min_scale, const ImVec4& colour) {
  const std::vector<float> points = thinned(history, magnitude);
  const float max = *std::max_element(points.begin(), points.end());
  const double now = history.empty() ? 0 : magnitude(history.back());
  ImGui::Text("%s  %.2f %s  (5 s, up to %.2f)", name, now, unit, static_cast<double>(max));
  ImGui::PushStyleColor(ImGuiCol_PlotLines, colour);
  ImGui::PlotLines((std::string("##") + name).c_str(), points.data(), static_cast<int>(points.size()), 0,
                   nullptr, 0, std::max(1.1f * max, min_scale),
                   {ImGui::GetContentRegionAvail().x, ui::px(56)});
  ImGui::PopStyleColor();
}

void draw_faults(const std::deque<TickRecord>& history) {
  const auto clamped = std::count_if(history.begin(), history.end(), [](const TickRecord& record) {
    return record.fault == WrenchFault::force_clamped || record.fault == WrenchFault::torque_clamped ||
           record.fault == WrenchFault::force_and_torque_clamped;
  });
  const auto not_finite = std::count_if(history.begin(), history.end(), [](const TickRecord& record) {
    return record.fault == WrenchFault::not_finite;
  });
  const auto no_pose = std::count_if(history.begin(), history.end(), [](const TickRecord& record) {
    return record.fault == WrenchFault::pose_not_finite;
  });
  const auto unsafe = std::count_if(history.begin(), history.end(), [](const TickRecord& record) {
    return record.fault == WrenchFault::pose_jumped || record.fault == WrenchFault::tick_late;
  });
  if (clamped > 0)
    ImGui::TextColored(ui::kWarning, "clamped to the limit: %d of 5000 ticks", static_cast<int>(clamped));
  if (not_finite > 0)
    ImGui::TextColored(ui::kWarning, "not finite, sent as zero: %d ticks", static_cast<int>(not_finite));
  if (no_pose > 0)
    ImGui::TextColored(ui::kWarning, "no pose to feel with: %d ticks", static_cast<int>(no_pose));
  if (unsafe > 0)
    ImGui::TextColored(ui::kWarning, "device jumped or tick late, sent as zero: %d ticks",
                       static_cast<int>(unsafe));
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
  row("removed", fmt::format("{:.2f} mm^3", state.record.removed_mm3));
  if (simulation.holder.hardware != nullptr) draw_device(view, *simulation.holder.hardware);
  ImGui::Separator();
  const auto& history = simulation.history;
  plot("force", "N", history, [](const TickRecord& r) { return r.wrench.force_N.norm(); }, 1.0f,
       {0.30f, 0.85f, 0.40f, 1});
  plot("torque", "N mm", history, [](const TickRecord& r) { return r.wrench.torque_Nmm.norm(); }, 5.0f,
       {0.98f, 0.76f, 0.25f, 1});
  draw_faults(history);
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
