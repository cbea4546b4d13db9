#include "app/simulate/view_aids_panel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include "app/simulate/bone_scene.h"
#include "app/simulate/files_panel.h"
#include "app/simulate/panels.h"
#include "app/simulate/scene_of.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

// Time constant for centring the burr, long enough to ignore tremor.
constexpr double kFollowing_s = 0.25;
// Side of the loupe as a fraction of the window's height.
constexpr double kLoupeShare = 0.4;

ImVec2 at(const Eigen::Vector2d& place) {
  return {static_cast<float>(place.x()), static_cast<float>(place.y())};
}

void draw_text(ImDrawList& list, const ImVec2& place, const std::string& text) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float edge = ui::px(3);
  list.AddRectFilled({place.x - edge, place.y - edge}, {place.x + size.x + edge, place.y + size.y + edge},
                     IM_COL32(20, 24, 30, 210), edge);
  list.AddText(place, IM_COL32(255, 232, 150, 255), text.c_str());
}

// Lower left, between the columns, where it hides neither the burr nor the bone's upper half.
Eigen::Vector2i loupe_corner(const PixelSize& size, int side_px) {
  return {static_cast<int>(ui::px(316)), size.height - side_px - static_cast<int>(ui::px(8))};
}

void take_click(ViewState& view, const Simulation& simulation, const PixelSize& size) {
  const ImGuiIO& io = ImGui::GetIO();
  if (!ui::is_click(0) || io.WantCaptureMouse || view.holding_tool || io.KeyCtrl) return;
  std::optional<Vec3> point_W;
  simulation.milling.follower().read([&](const Volume& bone) {
    point_W = bone_point_seen_at(bone, view.camera, size,
                                 {static_cast<double>(io.MousePos.x), static_cast<double>(io.MousePos.y)},
                                 planes_of(view));
  });
  if (point_W) view.landmarks.push_back({fmt::format("P{}", view.landmarks.size() + 1), *point_W});
}

void draw_landmarks(const ViewState& view, const PixelSize& size) {
  constexpr ImU32 kInk = IM_COL32(255, 214, 64, 255), kDark = IM_COL32(0, 0, 0, 190);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto place = [&](const Landmark& mark) { return at(pixel_of(view.camera, size, mark.point_W)); };
  for (std::size_t n = 0; n + 1 < view.landmarks.size(); n += 2) {
    const ImVec2 from = place(view.landmarks[n]), to = place(view.landmarks[n + 1]);
    list.AddLine(from, to, kDark, ui::px(4));
    list.AddLine(from, to, kInk, ui::px(2));
    draw_text(list, {0.5f * (from.x + to.x) + ui::px(6), 0.5f * (from.y + to.y)},
              fmt::format("{:.2f} mm", distance_mm(view.landmarks[n], view.landmarks[n + 1])));
  }
  for (const Landmark& mark : view.landmarks) {
    const ImVec2 middle = place(mark);
    list.AddCircleFilled(middle, ui::px(5), kDark);
    list.AddCircleFilled(middle, ui::px(3.5f), kInk);
    draw_text(list, {middle.x + ui::px(8), middle.y - 1.5f * ImGui::GetTextLineHeight()}, mark.name);
  }
}

void draw_list(std::vector<Landmark>& landmarks) {
  for (std::size_t n = 0; n < landmarks.size(); ++n) {
    Landmark& mark = landmarks[n];
    ImGui::PushID(static_cast<int>(n));
    std::array<char, 32> name{};
    mark.name.copy(name.data(), name.size() - 1);
    ImGui::SetNextItemWidth(ui::px(84));
    ui::text_field(fmt::format("##landmark {}", n + 1).c_str(), "Name of this point", name.data(),
                   name.size());
    mark.name = name.data();
    ImGui::SameLine();
    ImGui::Text("%.2f %.2f %.2f", mark.point_W.x(), mark.point_W.y(), mark.point_W.z());
    if (n % 2 == 1) ImGui::Text("      %.2f mm to the point above", distance_mm(landmarks[n - 1], mark));
    ImGui::PopID();
  }
}

std::string table_text(const std::vector<Landmark>& landmarks) {
  std::string text = "name\tx_mm\ty_mm\tz_mm\n";
  for (const Landmark& mark : landmarks)
    text += fmt::format("{}\t{:.3f}\t{:.3f}\t{:.3f}\n", mark.name, mark.point_W.x(), mark.point_W.y(),
                        mark.point_W.z());
  return text;
}

}  // namespace

void update_view_aids(ViewState& view, Simulation& simulation, const PixelSize& size) {
  const ImGuiIO& io = ImGui::GetIO();
  if (is_dialogue_open()) return;
  if (!io.WantTextInput && !io.KeyCtrl) {
    if (ui::is_key_pressed(GLFW_KEY_V)) view.follow_burr = !view.follow_burr;
    if (ui::is_key_pressed(GLFW_KEY_L)) view.loupe = !view.loupe;
    if (ui::is_key_pressed(GLFW_KEY_R)) view.measuring = !view.measuring;
    // The list of points is in that group.
    if (view.measuring && ui::is_key_pressed(GLFW_KEY_R)) view.open.closer = true;
  }
  if (view.measuring) take_click(view, simulation, size);
  if (!view.follow_burr) return;
  const Vec3 away_mm = simulation.milling.state().record.X_WT.position_mm - view.camera.focus_W;
  const double share = 1 - std::exp(-static_cast<double>(io.DeltaTime) / kFollowing_s);
  // Do not move a view at rest, which is drawn in full detail.
  const double pixel_mm = mm_per_pixel(view.camera, size, view.camera.distance_mm);
  if (away_mm.norm() > pixel_mm) view.camera.focus_W += share * away_mm;
}

void draw_view_aids(const ViewState& view, const ViewScene& scene, BoneScene& bone, const PixelSize& size) {
  draw_landmarks(view, size);
  if (!view.loupe || !scene.X_WT) return;
  const int side = static_cast<int>(kLoupeShare * size.height);
  const Eigen::Vector2i corner_px = loupe_corner(size, side);
  const PixelSize inset{side, side};
  ViewScene magnified = scene;
  magnified.camera =
      loupe_camera(scene.camera, size, scene.X_WT->position_mm, inset, static_cast<double>(view.loupe_power));
  bone.draw_inset(magnified, inset, corner_px, size);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto length = static_cast<float>(side);
  const ImVec2 corner(static_cast<float>(corner_px.x()), static_cast<float>(corner_px.y()));
  list.AddRect(corner, {corner.x + length, corner.y + length}, IM_COL32(255, 255, 255, 220), 0, 0, ui::px(2));
  draw_text(list, {corner.x + ui::px(6), corner.y + ui::px(6)},
            fmt::format("{:.1f} x", static_cast<double>(view.loupe_power)));
}

void draw_view_aid_controls(ViewState& view, const FilesPanel& files) {
  if (!ui::header("Look closer", "See through bone, follow and magnify the burr, and measure in mm",
                  view.open.closer))
    return;
  ui::checkbox("see through", kSeeThroughHint, &view.see_through);
  ui::checkbox("follow the burr (V)", "Keeps the burr at the centre of the view", &view.follow_burr);
  ui::checkbox("loupe (L)", "Shows a magnified picture of the burr's surroundings", &view.loupe);
  if (view.loupe)
    ui::slider("power", "Magnification of the loupe relative to the view", &view.loupe_power, 2, 4, "%.1f x",
               ImGuiSliderFlags_AlwaysClamp);
  ui::checkbox("measure (R)",
               "Marks the points of bone that you click, and shows the distance of each pair in mm",
               &view.measuring);
  if (view.landmarks.empty()) return;
  draw_list(view.landmarks);
  if (ui::button("Copy points", "Copies names and coordinates (LPS, mm) as a table"))
    ImGui::SetClipboardText(table_text(view.landmarks).c_str());
  ui::same_line_if_room("Save points");
  if (ui::button("Save points", "Saves the points as a 3D Slicer markups file"))
    files.save_text(view, "landmarks.mrk.json", markups_text(view.landmarks));
  ui::same_line_if_room("Clear points");
  if (ui::button("Clear points", "Removes all points and distances")) view.landmarks.clear();
}

void draw_grey(ViewState& view, const WindowLevel& first) {
  const WindowLevel grey = view.grey_window.value_or(first);
  ImGui::AlignTextToFramePadding();
  ImGui::Text("grey: level %.0f, window %.0f", 0.5 * (grey.black + grey.white), grey.white - grey.black);
  ui::tooltip("Drag a cut with Ctrl and the right button: right for less contrast, down for lighter greys");
  ImGui::SameLine();
  if (ui::button("Reset grey", "Restores the initial window and level of the cuts",
                 view.grey_window.has_value()))
    view.grey_window.reset();
}

}  // namespace osteomill::app
