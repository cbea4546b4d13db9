#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/core.h>

#include "osteomill/session/milling_entry.h"
#include "osteomill/volume/bone_densities.h"

#include "tests/shapes.h"
#include "tests/swept_path.h"
#include "verification/in_parallel.h"
#include "verification/sections.h"
#include "verification/trial_figures.h"

namespace osteomill::verification {

namespace {

using testing_support::Carving;

constexpr double kVolumeWithin = 0.02;
constexpr double kPaidWithin = 0.01;
// Largest difference between the cut shares of holes with the same burr and push.
constexpr double kShareTolerance = 0.015;

struct Hole {
  const char* name;
  Vec3 spacing_mm = Vec3::Constant(0.2);
  double burr_radius_mm = 1.5;
  double push_N = 1.5;
  // Side of the block, mm, and duration relative to the usual one.
  double side_mm = 10;
  double time = 1;
  Quat turn = Quat::Identity();
};

std::vector<Hole> holes() {
  const Quat turn = Quat(0.8, 0.3, -0.4, 0.33).normalized();
  return {{"0.25 mm", Vec3::Constant(0.25)},
          {"0.20 mm"},
          {"0.10 mm", Vec3::Constant(0.10)},
          {"0.05 mm", Vec3::Constant(0.05), 1.5, 1.5, 7, 0.7},
          {"0.031 mm", Vec3::Constant(0.03125), 1.5, 1.5, 6, 0.5},
          {"0.3 x 0.3 x 0.7 mm", Vec3(0.3, 0.3, 0.7), 1.5, 1.5, 14},
          {"0.20 mm, grid turned", Vec3::Constant(0.2), 1.5, 1.5, 10, 1, turn},
          {"0.10 mm, burr of 0.5 mm", Vec3::Constant(0.10), 0.5, 1.5, 7},
          {"0.20 mm, burr of 3 mm", Vec3::Constant(0.20), 3, 3, 14, 1.5},
          {"0.20 mm, 0.5 N", Vec3::Constant(0.2), 1.5, 0.5},
          {"0.20 mm, 3 N", Vec3::Constant(0.2), 1.5, 3},
          {"0.20 mm, 9 N", Vec3::Constant(0.2), 1.5, 9, 16, 0.7}};
}

// Returns a block that is rotated with its grid, so that an entry is found as in the unrotated one.
Volume block(const Hole& hole) {
  GridGeometry grid;
  grid.spacing_mm = hole.spacing_mm;
  grid.direction = hole.turn.toRotationMatrix();
  Vec3 last;
  for (int axis = 0; axis < 3; ++axis) {
    const int count = static_cast<int>(std::lround(hole.side_mm / hole.spacing_mm[axis]));
    grid.dims[static_cast<std::size_t>(axis)] = count;
    last[axis] = (count - 1) * hole.spacing_mm[axis];
  }
  grid.origin_mm = -0.5 * (hole.turn * last);
  constexpr double kEdge_mm = 0.4;
  const double half = 0.5 * hole.side_mm - 0.5;
  return testing_support::shape_volume(
      grid,
      [&](const Vec3& point_W) { return (hole.turn.conjugate() * point_W).cwiseAbs().maxCoeff() - half; },
      kEdge_mm / hole.spacing_mm.minCoeff());
}

struct Milled {
  Carving carving;
  double paid_share = 0;
};

Milled mill(const Hole& hole, double seconds) {
  const Volume bone = block(hole);
  TrialSettings settings;
  settings.tool.burr_radius_mm = hole.burr_radius_mm;
  settings.tool.shaft_radius_mm = std::min(settings.tool.shaft_radius_mm, 0.7 * hole.burr_radius_mm);
  settings.hand_and_device.hand.push_N = hole.push_N;
  settings.hand_and_device.script.milling_s = seconds * hole.time;
  MillingTrial trial(bone, estimate_densities(bone), place_entry(bone, settings.tool), settings);
  std::vector<Vec3> path_W;
  double paid_for_mm3 = 0, removed_mm3 = 0;
  for (MillingTrial::Tick tick = trial.tick(); tick.milling_phase; tick = trial.tick()) {
    const double force_N = tick.record.burr_force_W_N.norm();
    if (force_N > 0) path_W.push_back(tick.record.X_WT.position_mm);
    paid_for_mm3 += milling_settings(settings).removal_rate_mm3_per_Ns * force_N * settings.tick_s;
    removed_mm3 = tick.record.removed_mm3;
  }
  if (path_W.empty()) return {};
  const double spacing_mm = hole.spacing_mm.minCoeff();
  const testing_support::SweptPath path(path_W, hole.burr_radius_mm,
                                        spacing_mm / std::ceil(spacing_mm / 0.06));
  return {testing_support::carving(bone, trial.volume(), path), removed_mm3 / paid_for_mm3};
}

// Adds a row that compares the holes that differ only in voxel size.
void add_all_voxels(Section& section, const std::vector<Hole>& holes, const std::vector<Milled>& milled) {
  const Hole usual{};
  std::vector<double> shares;
  for (std::size_t n = 0; n < holes.size(); ++n) {
    if (holes[n].burr_radius_mm == usual.burr_radius_mm && holes[n].push_N == usual.push_N)
      shares.push_back(milled[n].carving.share());
  }
  const auto [least, greatest] = std::minmax_element(shares.begin(), shares.end());
  section.add({"all voxels", "", fmt::format("{:.3f} to {:.3f}", *least, *greatest), "", "", "", ""},
              *greatest / *least - 1 <= kShareTolerance);
}

}  // namespace

Section swept_holes(const Effort& effort) {
  Section section{
      "Cut volume and swept volume",
      fmt::format(
          "Must hold: the cut volume equals the volume that the drawn burr sweeps while it presses, "
          "within {:.0f} %; no bone remains deeper inside the swept volume than half a voxel, and none "
          "is removed farther outside it than the lesser of a quarter of a voxel and 0.03 mm; the "
          "removed volume is what the burr's force paid for within {:.0f} %. Blocks of bone, milled and "
          "leant against by the simulated hand (burr of 1.5 mm radius, 1.5 N, {:.0f} s in most "
          "rows); surfaces are interpolated, and counted only inside bone that extends two "
          "voxels around. Edges that remain between two passes are rounded within their voxels, because "
          "densities are interpolated; they are reported separately and not judged. With one burr and "
          "push the cut shares agree within {:g} % over all voxel sizes.",
          100 * kVolumeWithin, 100 * kPaidWithin, effort.phase_s / 2, 100 * kShareTolerance),
      {"voxels", "swept, mm3", "cut / swept", "left, mm", "lost, mm", "lost at edges, mm",
       "removed / paid for", ""},
      {},
      {}};
  const std::vector<Hole> all = holes();
  std::vector<Milled> milled(all.size());
  in_parallel(milled.size(), [&](std::size_t n) { milled[n] = mill(all[n], effort.phase_s / 2); });
  for (std::size_t n = 0; n < milled.size(); ++n) {
    const Hole& hole = all[n];
    const Carving& c = milled[n].carving;
    const double voxel_mm = hole.spacing_mm.maxCoeff();
    section.add({hole.name, figure(c.swept_mm3), fmt::format("{:.3f}", c.share()),
                 fmt::format("{:.3f}", c.left_mm), fmt::format("{:.3f}", c.lost_mm),
                 fmt::format("{:.3f}", c.edge_lost_mm), fmt::format("{:.4f}", milled[n].paid_share)},
                std::abs(c.share() - 1) <= kVolumeWithin && c.left_mm <= 0.5 * voxel_mm &&
                    c.lost_mm <= std::min(0.25 * voxel_mm, 0.03) &&
                    std::abs(milled[n].paid_share - 1) <= kPaidWithin);
  }
  add_all_voxels(section, all, milled);
  return section;
}

}  // namespace osteomill::verification
