#include "osteomill/milling/burr_mill.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace osteomill {

namespace {

constexpr double kForgetAfter_s = 0.05;
constexpr double kCarryLayer_voxels = 0.5;
// Each pass settles the voxels that are emptied; more than a few are needed only where a single step empties
// nearly everything in reach, and what is left then is carried.
constexpr int kSpreadingPasses = 8;

struct IndexRange {
  int first;
  int last;
};

// The indices from 0 to count - 1 whose positions (index * spacing) lie within `half_width` of `centre`.
IndexRange indices_within(double centre_mm, double half_width_mm, double spacing_mm, int count) {
  const double first = std::ceil((centre_mm - half_width_mm) / spacing_mm);
  const double last = std::floor((centre_mm + half_width_mm) / spacing_mm);
  return {static_cast<int>(std::clamp(first, 0.0, static_cast<double>(count))),
          static_cast<int>(std::clamp(last, -1.0, static_cast<double>(count - 1)))};
}

// The least float that is not below `density`.
float float_not_below(double density) {
  const float nearest = static_cast<float>(density);
  return static_cast<double>(nearest) < density
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

// The cells of all voxel centres in a ball lie in the ball grown by half a cell's diagonal.
std::size_t most_voxels_in_ball(const GridGeometry& geometry, double radius_mm) {
  const double grown_mm = radius_mm + 0.5 * geometry.spacing_mm.norm();
  const double most =
      4.0 / 3.0 * std::numbers::pi * grown_mm * grown_mm * grown_mm / geometry.voxel_volume_mm3();
  return static_cast<std::size_t>(std::min(most + 1, static_cast<double>(geometry.voxel_count())));
}

std::size_t most_rows_in_ball(const GridGeometry& geometry, double radius_mm) {
  const double columns = std::min(2 * radius_mm / geometry.spacing_mm.y() + 1, double(geometry.dims[1]));
  const double slices = std::min(2 * radius_mm / geometry.spacing_mm.z() + 1, double(geometry.dims[2]));
  return static_cast<std::size_t>(columns + 1) * static_cast<std::size_t>(slices + 1);
}

}  // namespace

BurrMill::BurrMill(const GridGeometry& geometry, double burr_radius_mm, const BoneDensities& densities,
                   const MillingSettings& settings)
    : geometry_(geometry) {
  require(geometry.voxel_count() > 0 && geometry.spacing_mm.minCoeff() > 0 && geometry.spacing_mm.allFinite(),
          "BurrMill: an empty grid");
  require(burr_radius_mm > 0 && std::isfinite(burr_radius_mm), "BurrMill: the burr's radius must be above 0");
  require(settings.removal_rate_mm3_per_Ns >= 0 && std::isfinite(settings.removal_rate_mm3_per_Ns),
          "BurrMill: the removal rate must not be below 0");
  require(settings.reach_voxels >= 0 && std::isfinite(settings.reach_voxels),
          "BurrMill: the reach must not be below 0");
  require(std::isfinite(densities.surroundings) && std::isfinite(densities.reference) &&
              densities.reference > densities.surroundings,
          "BurrMill: the reference density must be above that of the surroundings");
  const double spacing_mm = geometry.spacing_mm.minCoeff();
  cutting_radius_mm_ = burr_radius_mm + settings.reach_voxels * spacing_mm;
  mm3_per_density_ = geometry.voxel_volume_mm3() / (densities.reference - densities.surroundings);
  removal_rate_mm3_per_Ns_ = settings.removal_rate_mm3_per_Ns;
  greatest_carry_mm3_ =
      2 * std::numbers::pi * burr_radius_mm * burr_radius_mm * kCarryLayer_voxels * spacing_mm;
  floor_density_ = float_not_below(densities.surroundings);
  overlaps_.reserve(most_voxels_in_ball(geometry, cutting_radius_mm_));
  rows_.reserve(most_rows_in_ball(geometry, cutting_radius_mm_));
}

MillingStep BurrMill::step(Volume& volume, const Vec3& burr_centre_W, double burr_force_N, double dt_s) {
  const double pressed_mm3 = removal_rate_mm3_per_Ns_ * burr_force_N * dt_s;
  if (!(pressed_mm3 > 0) || !std::isfinite(pressed_mm3) || !burr_centre_W.allFinite()) {
    if (dt_s > 0) force_free_s_ += dt_s;
    if (force_free_s_ >= kForgetAfter_s) carry_mm3_ = 0;
    return {};
  }
  force_free_s_ = 0;
  const double budget_mm3 = carry_mm3_ + pressed_mm3;
  find_overlaps(volume, burr_centre_W);
  const MillingStep done = lower_overlaps(volume, drop_per_depth(budget_mm3 / mm3_per_density_));
  // Below zero by a rounding error where floats were rounded in the burr's favour; the next step pays for it.
  carry_mm3_ = std::min(budget_mm3 - done.removed_mm3, greatest_carry_mm3_);
  return done;
}

void BurrMill::reset() {
  carry_mm3_ = 0;
  force_free_s_ = 0;
}

void BurrMill::find_overlaps(const Volume& volume, const Vec3& burr_centre_W) {
  overlaps_.clear();
  rows_.clear();
  const Vec3 centre_mm = geometry_.direction.transpose() * (burr_centre_W - geometry_.origin_mm);
  const Vec3& spacing_mm = geometry_.spacing_mm;
  const double radius2 = cutting_radius_mm_ * cutting_radius_mm_;
  const IndexRange slices =
      indices_within(centre_mm.z(), cutting_radius_mm_, spacing_mm.z(), geometry_.dims[2]);
  for (int k = slices.first; k <= slices.last; ++k) {
    const double z = k * spacing_mm.z() - centre_mm.z();
    const double disc2 = radius2 - z * z;
    if (disc2 <= 0) continue;
    const IndexRange rows =
        indices_within(centre_mm.y(), std::sqrt(disc2), spacing_mm.y(), geometry_.dims[1]);
    for (int j = rows.first; j <= rows.last; ++j) {
      const double y = j * spacing_mm.y() - centre_mm.y();
      const double half2 = disc2 - y * y;
      if (half2 <= 0) continue;
      const IndexRange row =
          indices_within(centre_mm.x(), std::sqrt(half2), spacing_mm.x(), geometry_.dims[0]);
      const float* densities = volume.grid().densities().data() + volume.grid().linear_index({0, j, k});
      add_row(densities, row.first, row.last, j, k, centre_mm);
    }
  }
}

void BurrMill::add_row(const float* row_densities, int first_i, int last_i, int j, int k,
                       const Vec3& centre_mm) {
  const std::size_t begin = overlaps_.size();
  const double y = j * geometry_.spacing_mm.y() - centre_mm.y();
  const double z = k * geometry_.spacing_mm.z() - centre_mm.z();
  const double across2 = y * y + z * z;
  for (int i = first_i; i <= last_i; ++i) {
    const float left = row_densities[i] - floor_density_;
    if (!(left > 0)) continue;
    const double x = i * geometry_.spacing_mm.x() - centre_mm.x();
    const double depth_mm = cutting_radius_mm_ - std::sqrt(across2 + x * x);
    if (depth_mm > 0) overlaps_.push_back({i, static_cast<float>(depth_mm), left});
  }
  if (overlaps_.size() > begin) rows_.push_back({j, k, begin, overlaps_.size()});
}

// The drop per mm of depth, with each voxel's drop limited to what it holds, that spends the budget (a sum of
// densities): what the emptied voxels cannot take goes to the others, pass by pass.
double BurrMill::drop_per_depth(double density_budget) const {
  double rate = 0;
  for (int pass = 0; pass < kSpreadingPasses; ++pass) {
    double emptied = 0;
    double depths = 0;
    for (const Overlap& overlap : overlaps_) {
      const double depth = static_cast<double>(overlap.depth_mm);
      const double left = static_cast<double>(overlap.density_left);
      if (rate * depth >= left) {
        emptied += left;
      } else {
        depths += depth;
      }
    }
    if (!(depths > 0)) break;
    const double next = (density_budget - emptied) / depths;
    if (!(next > rate)) break;
    rate = next;
  }
  return rate;
}

MillingStep BurrMill::lower_overlaps(Volume& volume, double drop_per_depth) const {
  MillingStep done;
  double dropped = 0;
  for (const Row& row : rows_) {
    for (std::size_t n = row.begin; n < row.end; ++n) {
      const Overlap& overlap = overlaps_[n];
      const VoxelIndex v{overlap.i, row.j, row.k};
      const float before = volume.grid()[v];
      const float drop = static_cast<float>(drop_per_depth * static_cast<double>(overlap.depth_mm));
      const float after = std::max(before - drop, floor_density_);
      if (!(after < before)) continue;
      volume.lower_density(v, after);
      dropped += static_cast<double>(before) - static_cast<double>(after);
      done.change.voxels.include(v);
    }
  }
  done.removed_mm3 = dropped * mm3_per_density_;
  return done;
}

}  // namespace osteomill
