#include "published/point_shell/point_shell.h"

#include <numbers>
#include <sstream>
#include <stdexcept>

#include "setting_warnings.h"

namespace osteomill::point_shell {

namespace {

// Predicts the burr's force on the bone after a move from the derivatives before it. A contact only pushes:
// if the prediction is a pull, the burr has left and the force is zero.
Vec3 burr_force_after(const EnergySum& burr, const ToolMove& move) {
  const Vec3 before = -burr.gradient.head<3>();
  const Vec3 force = before - burr.convex.topLeftCorner<3, 3>() * move.translation_mm -
                     burr.convex.topRightCorner<3, 3>() * move.rotation_rad;
  return force.dot(before) > 0 ? Vec3(-force) : Vec3(Vec3::Zero());
}

}  // namespace

double contact_stiffness_N_per_mm3(const MillingTool& tool) {
  constexpr double kMaxForce_N = 20;
  const double r = tool.burr_radius_mm;
  // On a plane the burr's penalty force is kA pi (r - d) d^2, which peaks at d = 2r/3; the factor 1.5 is a
  // margin.
  return 1.5 * kMaxForce_N * 27 / (4 * std::numbers::pi * r * r * r);
}

std::vector<std::string> PointShell::setting_warnings(const MillingTool& tool,
                                                      const GridGeometry& scan) const {
  std::vector<std::string> warnings;
  add_stiffness_warning(warnings, "point-shell: a translational-stiffness",
                        settings_.translational_stiffness_N_per_mm);
  constexpr double kMaxTime_s = 0.02;
  if (settings_.damping_time_s > kMaxTime_s) {
    std::ostringstream line;
    line << "point-shell: a damping-time of " << settings_.damping_time_s
         << " s makes the force fade when the hand stops; use " << kMaxTime_s << " s or less";
    warnings.push_back(line.str());
  }
  const double apart_mm = settings_.scale * scan.spacing_mm.maxCoeff();
  if (apart_mm > tool.burr_radius_mm) {
    std::ostringstream line;
    line << "point-shell: at a scale of " << settings_.scale << " points lie " << apart_mm
         << " mm apart, more than the burr's radius of " << tool.burr_radius_mm << " mm: it slips between";
    warnings.push_back(line.str());
  }
  return warnings;
}

void PointShell::prepare(const AlgorithmInputs& inputs) {
  if (inputs.volume == nullptr) throw std::invalid_argument("point-shell: there is no volume");
  require_valid(inputs.tool);
  milling_tool_ = inputs.tool;
  coupling_ = {settings_.translational_stiffness_N_per_mm, settings_.torsional_stiffness_Nmm_per_rad,
               settings_.damping_time_s / inputs.tick_period_s};
  stiffness_N_per_mm3_ = contact_stiffness_N_per_mm3(inputs.tool);
  shell_ = VoxelShell(*inputs.volume, settings_.scale);
  tool_.emplace(inputs.tool, SampledDistanceField::suitable_spacing_mm(inputs.tool));
  reset();
}

void PointShell::reset() noexcept {
  X_WT_.reset();
  stretch_before_ = {};
}

HapticStep PointShell::step(const Pose& X_WD, double) noexcept {
  const Pose before = X_WT_.value_or(X_WD);
  const ToolContacts contacts =
      contacts_by_octree(shell_, milling_tool_, *tool_, before, stiffness_N_per_mm3_);
  const EnergySum all = contacts.total();
  HapticStep result;
  result.contacts = all.touching;
  result.X_WT = X_WD;
  if (all.touching > 0) {
    result.X_WT = moved(before, balancing_move(coupling_, before, X_WD, stretch_before_, all));
    result.wrench = wrench_on_hand(coupling_, result.X_WT, X_WD, stretch_before_);
    result.burr_force_W_N = burr_force_after(contacts.burr, move_between(before, result.X_WT));
  }
  X_WT_ = result.X_WT;
  stretch_before_ = move_between(X_WD, result.X_WT);
  return result;
}

}  // namespace osteomill::point_shell
