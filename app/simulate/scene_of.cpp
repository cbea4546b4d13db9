#include "app/simulate/scene_of.h"

#include "app/simulate/cuts.h"

namespace osteomill::app {

namespace {

constexpr double kApart_mm = 0.03;
constexpr double kApart_rad = 0.01;

}  // namespace

ViewScene scene_of(const ViewState& view, Simulation& simulation) {
  const LiveState& state = simulation.milling.state();
  const TickRecord& record = state.record;
  ViewScene scene;
  scene.camera = view.camera;
  scene.bounds = view.box.bounds();
  scene.tool = simulation.milling.setup().tool;
  scene.X_WT = record.X_WT;
  // Where both are the same the ghost would only tint the tool.
  const double apart_mm = (record.X_WD.position_mm - record.X_WT.position_mm).norm();
  const double apart_rad = record.X_WD.orientation.angularDistance(record.X_WT.orientation);
  if (view.ghost && (apart_mm > kApart_mm || apart_rad > kApart_rad)) scene.X_WD = record.X_WD;
  if (view.arrows) {
    scene.wrench = record.wrench;
    scene.intersection_W = state.intersection_W;
  }
  scene.show_labels = view.labels;
  scene.isovalue = simulation.milling.isovalue();
  scene.reference_density = simulation.milling.densities().reference;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    if (view.cuts[n].on) scene.cuts[n] = plane_of(view.cuts[n]);
  }
  return scene;
}

}  // namespace osteomill::app
