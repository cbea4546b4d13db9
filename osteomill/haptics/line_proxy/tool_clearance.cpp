#include "osteomill/haptics/line_proxy/tool_clearance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "osteomill/haptics/line_proxy/bone_surface.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

constexpr double kTolerance_mm = 1e-3;
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
  if (!is_bone_at(volume, middle_W + radius_W)) return;
  const double radius_mm = radius_W.norm();
  if (deepest) {
    const double min_mm = deepest->depth_mm + kWorthIt_mm;
    if (!(min_mm < radius_mm) || !is_bone_at(volume, middle_W + (1.0 - min_mm / radius_mm) * radius_W))
      return;
  }
  const double step_mm = 0.5 * volume.geometry().spacing_mm.minCoeff();
  Vec3 free_W = middle_W;
  Vec3 inside_W = middle_W + radius_W;
  for (double reach_mm = step_mm; reach_mm < radius_mm; reach_mm += step_mm) {
    const Vec3 here_W = middle_W + reach_mm / radius_mm * radius_W;
    if (is_bone_at(volume, here_W)) {
      inside_W = here_W;
      break;
    }
    free_W = here_W;
  }
  if (is_bone_at(volume, free_W)) return;  // the middle itself
  const Vec3 surface_W = bisect_crossing(volume, free_W, inside_W, kTolerance_mm);
  const double depth_mm = radius_mm - (surface_W - middle_W).norm();
  deepest = Overlap{middle_W, surface_W, radius_mm, depth_mm};
}

constexpr int kBurrDirections = 26;

// Towards the corners, edges and faces of a cube about the burr, in T.
Vec3 burr_direction(int n) {
  const int cell = n < kBurrDirections / 2 ? n : n + 1;  // the middle one is no direction
  return Vec3(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1).normalized();
}

std::optional<Overlap> deepest_overlap(const Volume& volume, const MillingTool& tool, const Pose& X_WT) {
  std::optional<Overlap> deepest;
  for (int n = 0; n < kBurrDirections; ++n) {
    look(volume, X_WT.position_mm, tool.burr_radius_mm * (X_WT.orientation * burr_direction(n)), deepest);
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
