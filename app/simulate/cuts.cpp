#include "app/simulate/cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <imgui.h>

namespace osteomill::app {

namespace {

// While milling goes on, pictures from one sampling of a cut to the next.
constexpr int kPicturesBetween = 8;
// Along the longer side of what a cut lays open.
constexpr int kMaxPixels = 320;

bool same(const ClipPlane& a, const ClipPlane& b) {
  return a.normal_W == b.normal_W && a.offset_mm == b.offset_mm;
}

// The cut that the line of sight through a pixel meets first within the bone's surroundings.
std::optional<std::size_t> cut_under(const ViewState& view, const PixelSize& size, double x_px, double y_px) {
  const Vec3 ray = ray_through(view.camera, size, x_px, y_px);
  const Vec3 eye = view.camera.eye_W();
  const Sphere bounds = view.box.bounds();
  double nearest_mm = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> found;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    const ViewState::Cut& cut = view.cuts[n];
    const double towards = ray.dot(cut.normal_W);
    if (!cut.on || std::abs(towards) < 1e-6) continue;
    const double way_mm = (static_cast<double>(cut.offset_mm) - cut.normal_W.dot(eye)) / towards;
    const Vec3 point_W = eye + way_mm * ray;
    if (way_mm <= 0 || way_mm > nearest_mm) continue;
    if ((point_W - bounds.centre_W).norm() > 1.1 * bounds.radius_mm) continue;
    nearest_mm = way_mm;
    found = n;
  }
  return found;
}

}  // namespace

ClipPlane plane_of(const ViewState::Cut& cut) {
  const double side = cut.other_side ? -1 : 1;
  return {side * cut.normal_W, side * static_cast<double>(cut.offset_mm)};
}

void CutUpdates::update(const ViewState& view, const Simulation& simulation, SceneRenderer& renderer) {
  ++pictures_;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    Shown& shown = shown_[n];
    if (!view.cuts[n].on) {
      shown.on = false;
      continue;
    }
    const ClipPlane plane = plane_of(view.cuts[n]);
    const bool milled =
        shown.bone_version != simulation.milling.bone_version() && pictures_ % kPicturesBetween == 0;
    if (shown.on && same(shown.plane, plane) && shown.labels == view.labels && !milled) continue;
    shown = {true, plane, view.labels, simulation.milling.bone_version()};
    simulation.milling.read_bone([&](const Volume& bone) {
      renderer.set_clip_face(n, clip_face(bone.grid(), plane, simulation.grey_window, kMaxPixels,
                                          view.labels ? bone.labels().get() : nullptr));
    });
  }
}

void reset_cuts(ViewState& view) {
  // What is cut away lies towards the viewer of the usual views: above, in front, to the patient's left.
  const Vec3 normals[] = {-Vec3::UnitZ(), Vec3::UnitY(), -Vec3::UnitX(), -view.camera.towards_viewer_W()};
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    view.cuts[n] = {};
    view.cuts[n].normal_W = normals[n];
  }
}

void begin_cut_at(const ViewState& view, ViewState::Cut& cut, const Vec3& tool_W) {
  constexpr double kLeast = 0.1;
  double least_mm = std::numeric_limits<double>::infinity();
  double most_mm = -least_mm;
  for (const Vec3& corner_W : view.box.corners_W) {
    least_mm = std::min(least_mm, cut.normal_W.dot(corner_W));
    most_mm = std::max(most_mm, cut.normal_W.dot(corner_W));
  }
  const double place_mm = cut.normal_W.dot(tool_W);
  cut.offset_mm = static_cast<float>(std::clamp(place_mm, least_mm, most_mm));
  // Beyond the bone, or near its end, it would leave nothing to be seen.
  cut.other_side = place_mm > most_mm - kLeast * (most_mm - least_mm);
}

Eigen::Vector2d pointer_moved_px() {
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  return {static_cast<double>(moved.x), static_cast<double>(moved.y)};
}

Eigen::Vector2d pointer_dragged_px() {
  const bool just_pressed = ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1) || ImGui::IsMouseClicked(2);
  return just_pressed ? Eigen::Vector2d::Zero() : pointer_moved_px();
}

bool drag_cut(ViewState& view, const PixelSize& size) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsMouseClicked(0) && io.KeyCtrl && !io.WantCaptureMouse) {
    const auto under =
        cut_under(view, size, static_cast<double>(io.MousePos.x), static_cast<double>(io.MousePos.y));
    view.dragged_cut = under ? static_cast<int>(*under) : -1;
  }
  if (!io.MouseDown[0]) view.dragged_cut = -1;
  if (view.dragged_cut < 0) return false;
  ViewState::Cut& cut = view.cuts[static_cast<std::size_t>(view.dragged_cut)];
  // The normal as it is seen, pixels a mm; towards the viewer it hardly moves in the picture: then upwards is
  // on.
  const Vec3 anchor_W = view.box.centre_W();
  Eigen::Vector2d seen =
      pixel_of(view.camera, size, anchor_W + cut.normal_W) - pixel_of(view.camera, size, anchor_W);
  const double full = 1 / mm_per_pixel(view.camera, size, depth_of(view.camera, anchor_W));
  if (seen.norm() < 0.2 * full) seen = Eigen::Vector2d(0, -full);
  cut.offset_mm += static_cast<float>(pointer_dragged_px().dot(seen) / seen.squaredNorm());
  return true;
}

}  // namespace osteomill::app
