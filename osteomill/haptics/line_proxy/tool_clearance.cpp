#include "osteomill/haptics/line_proxy/tool_clearance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

// A deeper place is looked for only where it is this much deeper.
constexpr double kWorthIt_mm = 0.02;
constexpr double kSliceSpacing_mm = 1.0;
constexpr int kSliceDirections = 8;

// Where bone reaches deepest below the surface of the tool, as seen from its middle there.
struct Overlap {
  Vec3 middle_W;
  Vec3 surface_W;
  double radius_mm;
  double depth_mm;
};

// Bone between a point of the tool's surface and the middle, where it reaches deeper than what is known.
void look(const Volume& volume, const Vec3& middle_W, const Vec3& radius_W, std::optional<Overlap>& deepest) {
  const double radius_mm = radius_W.norm();
  const double min_mm = deepest ? std::min(radius_mm, deepest->depth_mm + kWorthIt_mm) : 0;
  if (!is_bone_at(volume, middle_W + radius_W) ||
      !is_bone_at(volume, middle_W + (1 - min_mm / radius_mm) * radius_W) || is_bone_at(volume, middle_W)) {
    return;
  }
  if (const auto surface_W = first_crossing(volume, middle_W, middle_W + radius_W)) {
    deepest = Overlap{middle_W, *surface_W, radius_mm, radius_mm - (*surface_W - middle_W).norm()};
  }
}

std::optional<Overlap> deepest_overlap(const Volume& volume, const MillingTool& tool, const Pose& X_WT) {
  std::optional<Overlap> deepest;
  for (const Vec3& point_T : sphere_vertices(tool)) {
    look(volume, X_WT.position_mm, X_WT.orientation * point_T, deepest);
  }
  const int slices = std::max(1, static_cast<int>(tool.shaft_length_mm / kSliceSpacing_mm));
  for (int slice = 1; slice <= slices; ++slice) {
    const Vec3 middle_W = X_WT * Vec3(0, 0, tool.shaft_length_mm * slice / slices);
    for (int n = 0; n < kSliceDirections; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / kSliceDirections;
      const Vec3 direction(std::cos(angle), std::sin(angle), 0.0);
      look(volume, middle_W, tool.shaft_radius_mm * (X_WT.orientation * direction), deepest);
    }
  }
  return deepest;
}

}  // namespace

std::optional<Vec3> clearing_move(const Volume& volume, const MillingTool& tool, const Pose& X_WT,
                                  const NormalRule& normal) {
  const auto overlap = deepest_overlap(volume, tool, X_WT);
  if (!overlap) return std::nullopt;
  const Vec3 inward = (overlap->middle_W - overlap->surface_W).normalized();
  const Vec3 out = surface_normal(volume, overlap->surface_W, normal).value_or(inward);
  const double away_mm = out.dot(overlap->middle_W - overlap->surface_W);
  return std::clamp(overlap->radius_mm - away_mm, 0.0, overlap->radius_mm) * out;
}

}  // namespace osteomill::line_proxy
