#include <algorithm>
#include <cmath>

#include "app/simulate/panels.h"
#include "app/simulate/widgets.h"
#include <fmt/core.h>
#include <imgui.h>

namespace osteomill::app {

namespace {

const ImVec4 kNoGo{1.0f, 0.38f, 0.30f, 1};
// Of what more there is, the list is scrolled.
constexpr float kMostRows = 12;
constexpr float kFewestRows = 2;
// Of help that is shown below, and of title and box above the rows, at the usual size of text.
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
  const ImVec4 text = label.no_go ? kNoGo : ImGui::GetStyleColorVec4(ImGuiCol_Text);
  ImGui::TextColored(text, "%s%s", label.name.c_str(), label.no_go ? " (no-go)" : "");
  const LabelCount::Entry& entry = simulation.label_count.entries()[n];
  if (entry.contacts > 0) {
    ui::hint(fmt::format("The burr touched it for {:.1f} s, first at {:.1f} s, and pressed with {:.2f} N on "
                         "average and {:.2f} N at most",
                         entry.time_s, entry.first_s, entry.force_mean_N, entry.force_max_N)
                 .c_str());
  }
  const std::vector<double>& removed_mm3 = simulation.removed_by_label_mm3;
  if (n + 1 >= removed_mm3.size() || (entry.contacts == 0 && removed_mm3[n + 1] == 0)) return;
  const std::string removed = fmt::format("{:.2f} mm³", removed_mm3[n + 1]);
  ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(removed.c_str()).x);
  ImGui::TextUnformatted(removed.c_str());
}

}  // namespace

float draw_labels(ViewState& view, const Simulation& simulation, const PixelSize& size, const Room& room) {
  const std::size_t count = simulation.label_count.labels().size();
  if (count == 0) return room.top_px;
  const float line_px = ImGui::GetTextLineHeightWithSpacing();
  const float rows_px = room.bottom_px - room.top_px - ui::px(kHead_px) - (view.help ? ui::px(kHelp_px) : 0);
  const float rows = std::min({static_cast<float>(count), kMostRows, rows_px / line_px});
  // Once help was read there is room for them.
  if (view.help && rows < kFewestRows) return room.top_px;
  ImGui::SetNextWindowPos({static_cast<float>(size.width) - ui::px(ui::kRightWidth_px + 8), room.top_px});
  ImGui::SetNextWindowSize({ui::px(ui::kRightWidth_px), 0});
  ImGui::Begin("Labels", nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  ui::checkbox("label colours", &view.labels);
  ui::hint("Shows bone in the colours of its label map. Beside each label stands how much of it was removed");
  ImGui::BeginChild("##labels", {0, std::floor(std::max(rows, kFewestRows) * line_px)});
  for (std::size_t n = 0; n < count; ++n) draw_row(simulation, n);
  ImGui::EndChild();
  const float below_px = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y + ui::px(8);
  ImGui::End();
  return below_px;
}

void draw_no_go(Simulation& simulation, const PixelSize& size) {
  constexpr double kShown_s = 4;
  const double now_s = simulation.milling.state().record.time_s;
  const auto last_s = simulation.label_count.last_no_go_s();
  if (!last_s || now_s - *last_s > kShown_s) return;
  const ImVec2 text_px = ImGui::CalcTextSize(simulation.no_go_text.c_str());
  const float margin = 0.7f * text_px.y;
  const ImVec2 place(0.5f * (static_cast<float>(size.width) - text_px.x), ui::px(48) + margin);
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  list.AddRectFilled({place.x - 2 * margin, place.y - margin},
                     {place.x + text_px.x + 2 * margin, place.y + text_px.y + margin},
                     IM_COL32(190, 25, 25, 245), margin);
  list.AddText(place, IM_COL32(255, 255, 255, 255), simulation.no_go_text.c_str());
}

}  // namespace osteomill::app
