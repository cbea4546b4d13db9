#include "osteomill/session/milling_setup.h"

#include <stdexcept>

#include <fmt/core.h>

namespace osteomill {

void require_workable(const MillingTool& tool, const GridGeometry& scan) {
  constexpr double kMaxLength_mm = 1000, kMaxVoxels = 150, kMinVoxels = 0.25;
  require_valid(tool);
  const Vec3 size_mm(scan.dims[0] * scan.spacing_mm.x(), scan.dims[1] * scan.spacing_mm.y(),
                     scan.dims[2] * scan.spacing_mm.z());
  const double widest_mm = size_mm.maxCoeff();
  const double voxel_mm = scan.spacing_mm.minCoeff();
  const auto require_narrower = [&](const char* what, double radius_mm) {
    if (2 * radius_mm <= widest_mm) return;
    throw std::invalid_argument(fmt::format(
        "the {}'s radius, {:g} mm, makes it {:g} mm wide, and the scan is {:.3g} x {:.3g} x {:.3g} mm", what,
        radius_mm, 2 * radius_mm, size_mm.x(), size_mm.y(), size_mm.z()));
  };
  require_narrower("burr", tool.burr_radius_mm);
  require_narrower("shaft", tool.shaft_radius_mm);
  if (tool.shaft_length_mm > kMaxLength_mm) {
    throw std::invalid_argument(
        fmt::format("the shaft's length, {:g} mm, is over {:g} mm", tool.shaft_length_mm, kMaxLength_mm));
  }
  const double radius_voxels = tool.burr_radius_mm / voxel_mm;
  if (radius_voxels > kMaxVoxels || radius_voxels < kMinVoxels) {
    throw std::invalid_argument(
        fmt::format("the burr's radius, {:g} mm, is {:.3g} of the scan's voxels ({:.3g} mm); {:g} to {:g} "
                    "can be felt",
                    tool.burr_radius_mm, radius_voxels, voxel_mm, kMinVoxels, kMaxVoxels));
  }
}

MillingSettings milling_settings(const MillingSetup& setup) {
  MillingSettings milling;
  milling.removal_rate_mm3_per_Ns = setup.removal_rate_mm3_per_Ns
                                        ? *setup.removal_rate_mm3_per_Ns
                                        : removal_rate_mm3_per_Ns(setup.cutting, setup.tool.burr_radius_mm);
  if (setup.cutting_reaction) milling.reaction_share = setup.cutting.tangential_share;
  return milling;
}

}  // namespace osteomill
