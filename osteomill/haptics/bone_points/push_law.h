#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

namespace osteomill {

/// The energy of bone near a core, per area of bone surface. With w = `width_mm`, p0 = `pressure_N_per_mm2`
/// and x = 1 - d / w it is psi(d) = (w p0 / 3) x^3 / (1 - x) for distances d < w, else zero. Soft at first
/// touch and infinite at the core, twice continuously differentiable, without a logarithm. Safe in the tick.
struct Barrier {
  double width_mm;
  double pressure_N_per_mm2;

  /// Nearer than this share of the width the barrier no longer grows, so that its values stay finite; no
  /// certified step comes so near.
  static constexpr double kNearestShare = 1e-3;

  /// psi (N/mm), p = -psi' (N/mm^2) and -p' = psi'' (N/mm^3).
  struct Value {
    double energy = 0;
    double pressure = 0;
    double stiffness = 0;
  };
  friend Value operator*(double area_mm2, const Value& v) {
    return {area_mm2 * v.energy, area_mm2 * v.pressure, area_mm2 * v.stiffness};
  }
  Value at(double distance_mm) const {
    const double share = std::max(distance_mm / width_mm, kNearestShare);
    if (!(share < 1)) return {};
    const double x = 1 - share, x2 = x * x;
    const double third = pressure_N_per_mm2 / 3;
    return {width_mm * third * x2 * x / share, third * x2 * (3 - 2 * x) / (share * share),
            third / width_mm * x * (6 - 6 * x + 2 * x2) / (share * share * share)};
  }
};

/// How a point of the shell pushes.
struct Penalty {
  /// kA: newton a mm of depth and a mm^2 of surface.
  double stiffness_N_per_mm3 = 1;
  /// 0 (paper): a point pushes with its own depth. Otherwise with the mean depth of the patch of surface that
  /// it stands for, a square of its area, but no larger than this.
  double max_patch_mm2 = 0;

  struct Push {
    double force_N;
    /// How the force grows with the depth.
    double stiffness_N_per_mm;
  };

  /// How far outside the tool a point may lie and still push.
  double reach_mm() const { return 0.5 * std::sqrt(max_patch_mm2); }

  /// The push of a point `depth_mm` deep in the tool (negative: outside it) that stands for `area_mm2` of
  /// surface; `cosine` is that between the surface's normal and the tool's, `curvature_per_mm` the sum of the
  /// tool's two principal curvatures. By itself a point pushes with k_c d, k_c = kA area (Eriksson
  /// 2012, 6.3). A patch of side a that meets the tool at an angle holds depths spread evenly over d -+ a
  /// sine / 2, less a^2 curvature / 24 in the mean as the tool bends away. The mean of those that are
  /// positive passes from 0 to d without a kink, so that points do not start to push all at once as the tool
  /// slides on.
  Push push(double depth_mm, double area_mm2, double cosine, double curvature_per_mm) const {
    const double k = stiffness_N_per_mm3 * area_mm2;
    const double patch_mm2 = std::min(area_mm2, max_patch_mm2);
    const double spread_mm = 0.5 * std::sqrt(patch_mm2 * std::max(0.0, 1 - cosine * cosine));
    const double mean_mm = depth_mm - patch_mm2 * curvature_per_mm / 24;
    if (mean_mm <= -spread_mm) return {0, 0};
    if (mean_mm >= spread_mm) return {k * mean_mm, k};
    const double part = (mean_mm + spread_mm) / (2 * spread_mm);
    return {k * part * part * spread_mm, k * part};
  }
};

/// How points push: by a barrier, or each by its penalty.
using PushLaw = std::variant<Barrier, Penalty>;

}  // namespace osteomill
