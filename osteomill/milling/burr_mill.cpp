#include "osteomill/milling/burr_mill.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "osteomill/numbers/positive.h"

namespace osteomill {

namespace {

constexpr double kForgetAfter_s = 0.05;
constexpr double kCarryLayer_voxels = 0.5;
// Each pass settles the voxels that are emptied; more than a few are needed only where a single step empties
// nearly everything in reach, and what is left then is carried.
constexpr int kSpreadingPasses = 8;
// So many voxels a tick are lowered at most, but for the first ticks in which there are more.
constexpr std::size_t kVoxelsOfTick = 512;
constexpr unsigned kMaxShares = 64;

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

double half_ball_area(double radius_mm) {
  return 2 * std::numbers::pi * radius_mm * radius_mm;
}

BurrReach make_reach(const GridGeometry& geometry, double burr_radius_mm, const BoneDensities& densities,
                     const MillingSettings& settings) {
  require(geometry.voxel_count() > 0 && geometry.spacing_mm.minCoeff() > 0 && geometry.spacing_mm.allFinite(),
          "BurrMill: an empty grid");
  require_positive(burr_radius_mm, "BurrMill: the burr's radius");
  require_not_negative(settings.removal_rate_mm3_per_Ns, "BurrMill: the removal rate");
  require_not_negative(settings.reach_voxels, "BurrMill: the reach");
  require(std::isfinite(densities.surroundings) && std::isfinite(densities.reference) &&
              densities.reference > densities.surroundings,
          "BurrMill: the reference density must be above that of the surroundings");
  return BurrReach(geometry, burr_radius_mm + settings.reach_voxels * geometry.spacing_mm.maxCoeff(),
                   float_not_below(densities.surroundings));
}

}  // namespace

BurrMill::BurrMill(const GridGeometry& geometry, double burr_radius_mm, const BoneDensities& densities,
                   const MillingSettings& settings)
    : mm3_per_density_(geometry.voxel_volume_mm3() / (densities.reference - densities.surroundings)),
      removal_rate_mm3_per_Ns_(settings.removal_rate_mm3_per_Ns),
      max_carry_mm3_(half_ball_area(burr_radius_mm) * kCarryLayer_voxels * geometry.spacing_mm.minCoeff()),
      floor_density_(float_not_below(densities.surroundings)),
      reach_(make_reach(geometry, burr_radius_mm, densities, settings)),
      lowered_(reach_.capacity()) {}

MillingStep BurrMill::step(Volume& volume, const Vec3& burr_centre_W, const Vec3& burr_force_W_N,
                           double dt_s) {
  const double pressed_mm3 = removal_rate_mm3_per_Ns_ * burr_force_W_N.norm() * dt_s;
  if (!(pressed_mm3 > 0) || !std::isfinite(pressed_mm3) || !burr_centre_W.allFinite()) {
    if (dt_s > 0) force_free_s_ += dt_s;
    if (force_free_s_ >= kForgetAfter_s) carry_mm3_ = 0;
    return {};
  }
  force_free_s_ = 0;
  const double budget_mm3 = carry_mm3_ + pressed_mm3;
  reach_.find(volume, burr_centre_W, share_);
  share_after(reach_.size());
  const MillingStep done = lower_overlaps(volume, drop_per_depth(budget_mm3 / mm3_per_density_));
  // Below zero by a rounding error where floats were rounded in the burr's favour; the next step pays for it.
  carry_mm3_ = std::min(budget_mm3 - done.removed_mm3, max_carry_mm3_);
  return done;
}

// A burr deep in its hole overlaps tens of thousands of voxels, and takes a thousandth of each in a tick.
// Every second line then takes twice as much every second tick, and so on: lines, since they sample all of
// the burr alike.
void BurrMill::share_after(std::size_t found) {
  found_of_round_ += found;
  ++share_.turn;
  const bool too_many = found > 2 * kVoxelsOfTick && share_.count < kMaxShares;
  if (!too_many && share_.turn < share_.count) return;
  const std::size_t all = too_many ? found * share_.count : found_of_round_;
  share_ = {};
  while (share_.count < kMaxShares && all > kVoxelsOfTick * share_.count) share_.count *= 2;
  found_of_round_ = 0;
}

void BurrMill::reset() {
  share_ = {};
  found_of_round_ = 0;
  carry_mm3_ = 0;
  force_free_s_ = 0;
  reach_.forget();
}

// At `rate` of drop per mm of depth: what the voxels hold that it empties, and the depths of the others.
// Summed in four lanes, for speed.
void BurrMill::sum_overlaps(double rate, double& emptied, double& depths) const {
  constexpr std::size_t kLanes = 4;
  const float* depths_mm = reach_.depths_mm();
  const float* densities = reach_.densities();
  double emptied_lane[kLanes] = {}, depths_lane[kLanes] = {};
  const auto add = [&](std::size_t n, std::size_t lane) {
    const double depth = static_cast<double>(depths_mm[n]);
    const double left = static_cast<double>(densities[n] - floor_density_);
    const bool empties = rate * depth >= left;
    emptied_lane[lane] += empties ? left : 0;
    depths_lane[lane] += empties ? 0 : depth;
  };
  std::size_t n = 0;
  for (; n + kLanes <= reach_.size(); n += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(n + lane, lane);
  }
  for (; n < reach_.size(); ++n) add(n, 0);
  emptied = (emptied_lane[0] + emptied_lane[1]) + (emptied_lane[2] + emptied_lane[3]);
  depths = (depths_lane[0] + depths_lane[1]) + (depths_lane[2] + depths_lane[3]);
}

// The drop per mm of depth, with each voxel's drop limited to what it holds, that spends the budget (a sum of
// densities): what the emptied voxels cannot take goes to the others, pass by pass.
double BurrMill::drop_per_depth(double density_budget) const {
  double rate = 0;
  for (int pass = 0; pass < kSpreadingPasses; ++pass) {
    double emptied = 0;
    double depths = 0;
    sum_overlaps(rate, emptied, depths);
    const double next = (density_budget - emptied) / depths;
    if (!(depths > 0) || !(next > rate)) break;
    rate = next;
  }
  return rate;
}

MillingStep BurrMill::lower_overlaps(Volume& volume, double drop_per_depth) {
  const float drop_per_mm = static_cast<float>(drop_per_depth);
  const float* before = reach_.densities();
  for (std::size_t n = 0; n < reach_.size(); ++n) {
    lowered_[n] = std::max(before[n] - drop_per_mm * reach_.depths_mm()[n], floor_density_);
  }
  MillingStep done;
  double dropped = 0;
  for (const BurrReach::Row& row : reach_.rows()) {
    std::size_t begin = row.begin;
    std::size_t end = row.end;
    while (begin < end && !(lowered_[begin] < before[begin])) ++begin;
    if (begin == end) continue;
    while (!(lowered_[end - 1] < before[end - 1])) --end;
    for (std::size_t n = begin; n < end; ++n) {
      dropped += static_cast<double>(before[n]) - static_cast<double>(lowered_[n]);
    }
    volume.lower_row(row.j, row.k, reach_.columns() + begin, lowered_.data() + begin, end - begin);
    done.change.voxels.include({reach_.columns()[begin], row.j, row.k});
    done.change.voxels.include({reach_.columns()[end - 1], row.j, row.k});
  }
  done.removed_mm3 = dropped * mm3_per_density_;
  return done;
}

}  // namespace osteomill
