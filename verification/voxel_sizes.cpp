#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "osteomill/session/milling_entry.h"
#include "osteomill/volume/bone_densities.h"

#include "tests/shapes.h"
#include "verification/in_parallel.h"
#include "verification/sections.h"
#include "verification/trial_figures.h"

namespace osteomill::verification {

namespace {

constexpr double kEdge_mm = 0.4;

// A block of bone 12 mm wide and 7 mm high, its top at z = 2, the same at every spacing.
Volume block(double spacing_mm) {
  using namespace testing_support;
  return shape_volume(
      centred_cube(static_cast<int>(std::lround(14 / spacing_mm)), spacing_mm),
      [](const Vec3& p) {
        return std::max({std::abs(p.x()) - 6, std::abs(p.y()) - 6, p.z() - 2, -5 - p.z()});
      },
      kEdge_mm / spacing_mm);
}

// Returns the volume removed from the block, mm^3 of full density, counted from the remaining densities.
double hole_mm3(double spacing_mm, double seconds) {
  const Volume bone = block(spacing_mm);
  TrialSettings settings;
  settings.hand_and_device.script.milling_s = seconds;
  MillingTrial trial(bone, estimate_densities(bone), place_entry(bone, settings.tool), settings);
  while (trial.tick().milling_phase) {
  }
  double lost = 0;
  for_each(bone.geometry().all_voxels(), [&](const VoxelIndex& v) {
    lost += static_cast<double>(bone.grid()[v] - trial.volume().grid()[v]);
  });
  return lost / 1000 * bone.geometry().voxel_volume_mm3();
}

}  // namespace

Section voxel_sizes(const Effort& effort) {
  Section section{
      "Hole volume by voxel size",
      fmt::format("Must hold: the hole's volume changes by less than 2 % from voxels of 0.25 to 0.10 mm. A "
                  "block of bone with an edge {} mm wide, milled and leant against by the simulated hand for "
                  "{:.0f} s, push 1.5 N; the volume is counted from the remaining densities.",
                  kEdge_mm, effort.phase_s / 2),
      {"voxels", "hole, mm3", "against 0.10 mm", "at most", ""},
      {},
      {}};
  const std::vector<double> spacings{0.10, 0.20, 0.25};
  std::vector<double> holes(spacings.size());
  in_parallel(holes.size(), [&](std::size_t n) { holes[n] = hole_mm3(spacings[n], effort.phase_s / 2); });
  for (std::size_t n = 0; n < holes.size(); ++n) {
    const double off = holes[n] / holes.front() - 1;
    section.add(
        {fmt::format("{:.2f} mm", spacings[n]), figure(holes[n]), fmt::format("{:+.2f} %", 100 * off), "2 %"},
        std::abs(off) < 0.02);
  }
  return section;
}

}  // namespace osteomill::verification
