#include "app/simulate/scene_of.h"

#include <algorithm>

namespace osteomill::app {

namespace {

// Frames between two samplings of a cut while bone is milled.
constexpr int kPicturesBetween = 8;
// If hand and tool are closer than this, the ghost would only tint the tool.
constexpr double kMinMove_mm = 0.03;
constexpr double kMinTurn_rad = 0.01;

}  // namespace

ClipPlane plane_of(const ViewState::SectionPlane& cut) {
  const double side = cut.other_side ? -1 : 1;
  return {side * cut.normal_W, side * static_cast<double>(cut.offset_mm)};
}

void CutUpdates::update(const ViewState& view, const BoneFollower& bone, const WindowLevel& grey_window,
                        const LabelMap* labels, SceneRenderer& renderer) {
  ++pictures_;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    std::optional<Shown>& shown = shown_[n];
    if (!view.cuts[n].on) {
      shown.reset();
      continue;
    }
    const ClipPlane plane = plane_of(view.cuts[n]);
    const std::uint64_t version = bone.version();
    const bool same_cut =
        shown && shown->plane == plane && shown->labels == labels && shown->grey == grey_window;
    if (same_cut && (shown->bone_version == version || pictures_ % kPicturesBetween != 0)) continue;
    shown = {plane, labels, grey_window, version};
    bone.read([&](const Volume& now) {
      renderer.set_clip_face(n, clip_face(now.grid(), plane, grey_window, labels));
    });
  }
}

void reset_cuts(ViewState& view) {
  // The removed side faces the viewer in the usual views: from above, from the front, from the patient's
  // left.
  const Vec3 normals[] = {-Vec3::UnitZ(), Vec3::UnitY(), -Vec3::UnitX(), -view.camera.towards_viewer_W()};
  view.grey_window.reset();
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    view.cuts[n] = {};
    view.cuts[n].normal_W = normals[n];
  }
}

void begin_cut_at(const ViewState& view, ViewState::SectionPlane& cut, const Vec3& tool_W) {
  constexpr double kLeast = 0.1;
  const auto [least_mm, most_mm] = extent_along(view.box.corners_W, cut.normal_W);
  const double place_mm = cut.normal_W.dot(tool_W);
  cut.offset_mm = static_cast<float>(std::clamp(place_mm, least_mm, most_mm));
  // Beyond the bone or near its end, the usual side would leave nothing visible.
  cut.other_side = place_mm > most_mm - kLeast * (most_mm - least_mm);
}

std::vector<ClipPlane> planes_of(const ViewState& view) {
  std::vector<ClipPlane> planes;
  for (const ViewState::SectionPlane& cut : view.cuts)
    if (cut.on) planes.push_back(plane_of(cut));
  return planes;
}

static ViewScene scene_of(const ViewState& view, const TickRecord& record, const SessionSettings& settings) {
  ViewScene scene;
  scene.camera = view.camera;
  scene.bounds = view.box.bounds();
  scene.tool = settings.setup.tool;
  scene.X_WT = record.X_WT;
  const double apart_mm = (record.X_WD.position_mm - record.X_WT.position_mm).norm();
  const double apart_rad = record.X_WD.orientation.angularDistance(record.X_WT.orientation);
  if (view.ghost && (apart_mm > kMinMove_mm || apart_rad > kMinTurn_rad)) scene.X_WD = record.X_WD;
  if (view.arrows) scene.wrench = record.wrench;
  scene.see_through = view.see_through;
  scene.reference_density = settings.densities.reference;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    if (view.cuts[n].on) scene.cuts[n] = plane_of(view.cuts[n]);
  }
  return scene;
}

ViewScene scene_of(const ViewState& view, Simulation& simulation) {
  const LiveMilling& milling = simulation.milling;
  const LiveState& state = simulation.milling.state();
  ViewScene scene = scene_of(view, state.record, {milling.setup(), milling.densities()});
  if (view.arrows) scene.intersection_W = state.intersection_W;
  scene.show_labels = simulation.has_visible_labels(view);
  scene.isovalue = milling.isovalue();
  return scene;
}

ViewScene scene_of(const ViewState& view, const Playback& playback) {
  ViewScene scene = scene_of(view, playback.record(), playback.settings());
  scene.show_labels = view.labels && playback.has_guidance();
  scene.isovalue = playback.run().isovalue;
  return scene;
}

}  // namespace osteomill::app
