#include "osteomill/milling/burr_mill.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "osteomill/base/positive.h"
#include "osteomill/haptics/sample_points.h"
#include "osteomill/milling/cut_voxels.h"
#include "osteomill/milling/pressing_reach.h"
#include "osteomill/volume/sampling.h"

namespace osteomill {

double removal_rate_mm3_per_Ns(const CuttingSettings& cutting, double burr_radius_mm) {
  require_positive(cutting.spindle_speed_rpm, "milling: the spindle's speed");
  require_positive(cutting.tangential_share, "milling: the tangential share");
  require_positive(cutting.specific_energy_Nmm_per_mm3, "milling: the specific cutting energy");
  require_positive(burr_radius_mm, "milling: the burr's radius");
  const double rim_speed_mm_s = 2 * std::numbers::pi * burr_radius_mm * cutting.spindle_speed_rpm / 60;
  return rim_speed_mm_s * cutting.tangential_share / cutting.specific_energy_Nmm_per_mm3;
}

namespace {

constexpr double kBudgetTimeout_s = 0.05;
constexpr double kMaxAhead_mm_s = 20;
// Target and hard limit for the row pieces per tick. The limit applies if skipping lines would leave height
// differences above kMaxUneven_voxels.
constexpr std::size_t kPiecesOfTick = 1024;
constexpr std::size_t kMaxPiecesOfTick = 4096;
constexpr double kMaxUneven_voxels = 0.6;
// Capacity: also bounds the first ticks, in which the number of pieces is not known yet.
constexpr std::size_t kPieceCapacity = 2 * kMaxPiecesOfTick;
constexpr unsigned kMaxShares = 64;
// Largest budget carried over, as a time of pressing, s: a burr may bounce on the bone and lose contact for
// some ticks.
constexpr double kMaxCarry_s = 0.01;
// Time constant of the estimate of the cut bone. If shorter, the rate follows single voxels.
constexpr double kMeasured_s = 0.005;
// Directions in which density is sampled; half of them point ahead.
constexpr int kDirections = 48;
// Lower bound on the contact area relative to the burr's cross-section; bounds the chip thickness.
constexpr double kMinContact = 0.01;
// Smallest density, relative to the reference, that counts as bone.
constexpr double kMinDensity = 0.05;

// Returns the smallest float that is not below `density`.
float float_not_below(double density) {
  const float nearest = static_cast<float>(density);
  return static_cast<double>(nearest) < density
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

// Half a voxel more than the pressing reach, because the interpolated surface may be off by that much: bone
// that counts as pressed on must be within reach of the cut.
double max_ahead(const GridGeometry& geometry) {
  constexpr double kFarther_voxels = 0.5;
  return pressing_reach_mm(geometry) + kFarther_voxels * geometry.spacing_mm.maxCoeff();
}

// Returns the (negative) advance at which the leading half cuts nothing, however deep in bone the burr is.
double min_ahead(const GridGeometry& geometry, double radius_mm) {
  return -radius_mm - CutProfile::kReach_voxels * geometry.spacing_mm.maxCoeff();
}

// Returns the radius of a ball about the midpoint that encloses the burr at both its shown and its advanced
// position.
double reach_mm(const GridGeometry& geometry, double radius_mm, double ahead_mm) {
  return radius_mm + 0.5 * ahead_mm + CutProfile::kReach_voxels * geometry.spacing_mm.maxCoeff();
}

BurrReach make_reach(const Volume& volume, double burr_radius_mm, const BoneDensities& densities,
                     const MillingSettings& settings) {
  const GridGeometry& geometry = volume.geometry();
  require(geometry.voxel_count() > 0 && geometry.spacing_mm.minCoeff() > 0 && geometry.spacing_mm.allFinite(),
          "BurrMill: an empty grid");
  require_positive(burr_radius_mm, "BurrMill: the burr's radius");
  require_not_negative(settings.removal_rate_mm3_per_Ns, "BurrMill: the removal rate");
  require(std::isfinite(densities.surroundings) && std::isfinite(densities.reference) &&
              densities.reference > densities.surroundings,
          "BurrMill: the reference density must be above that of the surroundings");
  return BurrReach(volume, reach_mm(geometry, burr_radius_mm, max_ahead(geometry)),
                   float_not_below(densities.surroundings), kPieceCapacity);
}

}  // namespace

BurrMill::BurrMill(Volume& volume, double burr_radius_mm, const BoneDensities& densities,
                   const MillingSettings& settings)
    : volume_(&volume),
      radius_mm_(burr_radius_mm),
      densities_(densities),
      mm3_per_density_(volume.geometry().voxel_volume_mm3() / (densities.reference - densities.surroundings)),
      settings_(settings),
      min_ahead_mm_(min_ahead(volume.geometry(), burr_radius_mm)),
      max_ahead_mm_(max_ahead(volume.geometry())),
      reach_(make_reach(volume, burr_radius_mm, densities, settings)),
      voxels_(volume.geometry(), reach_.max_voxels(), reach_.max_pieces()) {
  if (settings_.chips) directions_ = spiral_directions(kDirections);
}

double BurrMill::rate_mm3_s(double force_N, double speed_share) const {
  if (!settings_.chips) return settings_.removal_rate_mm3_per_Ns * force_N * speed_share;
  const double min_area_mm2 = kMinContact * std::numbers::pi * radius_mm_ * radius_mm_;
  return cut_bone_.density *
         cut_chips(*settings_.chips, {force_N, radius_mm_, settings_.spindle_speed_rpm * speed_share,
                                      std::max(cut_bone_.area_mm2, min_area_mm2), cut_bone_.density})
             .rate_mm3_s;
}

MillingStep BurrMill::step(const Vec3& burr_centre_W, const Vec3& burr_force_W_N, double dt_s,
                           double speed_share) noexcept {
  const double force_N = burr_force_W_N.norm();
  if (settings_.chips && force_N > 0 && std::isfinite(force_N) && burr_centre_W.allFinite())
    sample_ahead(burr_centre_W, burr_force_W_N / force_N, dt_s);
  const double paid_mm3_s = rate_mm3_s(force_N, speed_share);
  const double pressed_mm3 = paid_mm3_s * dt_s;
  if (!(pressed_mm3 > 0) || !std::isfinite(pressed_mm3) || !burr_centre_W.allFinite()) {
    step_without_force(dt_s);
    return {};
  }
  force_free_s_ = 0;
  const double budget_mm3 = unspent_mm3_ + pressed_mm3;
  const CuttingBall ball = ball_in_grid(burr_centre_W, burr_force_W_N);
  const double max_ahead_mm = std::min(std::max(ahead_mm_, 0.0) + kMaxAhead_mm_s * dt_s, max_ahead_mm_);
  const double lines = share_.count;
  find(ball, max_ahead_mm, pressed_mm3);
  const BurrAdvance advance =
      advance_within(budget_mm3 / mm3_per_density_, voxels_, ahead_mm_, min_ahead_mm_, max_ahead_mm);
  ahead_mm_ = advance.ahead_mm;
  MillingStep done = lower_found(voxels_.find_lowered(ahead_mm_, advance.shares));
  done.rate_mm3_s = paid_mm3_s;
  if (settings_.chips) measure_contact(lines * advance.slope_per_mm, dt_s);
  // May be slightly negative by float rounding; the next step pays for it.
  unspent_mm3_ = std::min(budget_mm3 - done.removed_mm3, kMaxCarry_s * paid_mm3_s);
  return done;
}

// Samples the bone just beyond the reach of the profile, which still has its scanned densities.
void BurrMill::sample_ahead(const Vec3& centre_W, const Vec3& ahead_W, double dt_s) {
  const double reach_mm = radius_mm_ + CutProfile::kReach_voxels * geometry().spacing_mm.maxCoeff();
  const Vec3 from_W = centre_W + std::max(ahead_mm_, 0.0) * ahead_W;
  const double range = densities_.reference - densities_.surroundings;
  double weights = 0, sum = 0, squares = 0;
  for (const Vec3& direction_W : directions_) {
    const double weight = direction_W.dot(ahead_W);
    if (weight <= 0) continue;
    const double density =
        (density_at(volume_->grid(), from_W + reach_mm * direction_W) - densities_.surroundings) / range;
    if (!(density > kMinDensity)) continue;
    weights += weight;
    sum += weight * density;
    squares += weight * density * density;
  }
  if (!(weights > 0)) return;
  const double mean = sum / weights;
  const double share = cut_bone_.area_mm2 == 0 ? 1 : dt_s / (kMeasured_s + dt_s);
  cut_bone_.density += share * (mean - cut_bone_.density);
  cut_bone_.grain +=
      share * (std::sqrt(std::max(0.0, squares / weights - mean * mean)) / mean - cut_bone_.grain);
}

void BurrMill::measure_contact(double slope_per_mm, double dt_s) {
  if (!(slope_per_mm > 0)) return;
  const double area_mm2 = slope_per_mm * mm3_per_density_ / cut_bone_.density;
  const double share = cut_bone_.area_mm2 == 0 ? 1 : dt_s / (kMeasured_s + dt_s);
  cut_bone_.area_mm2 += share * (area_mm2 - cut_bone_.area_mm2);
}

void BurrMill::step_without_force(double dt_s) {
  if (dt_s > 0) force_free_s_ += dt_s;
  if (force_free_s_ < kBudgetTimeout_s) return;
  unspent_mm3_ = 0;
  ahead_mm_ = 0;
  cut_bone_ = {};
}

CuttingBall BurrMill::ball_in_grid(const Vec3& centre_W, const Vec3& force_W_N) const {
  const auto to_grid = geometry().direction.transpose();
  return {to_grid * (centre_W - geometry().origin_mm), to_grid * force_W_N.normalized(), radius_mm_};
}

void BurrMill::find(const CuttingBall& ball, double max_ahead_mm, double pressed_mm3) {
  reach_.find(ball.centre_mm + 0.5 * max_ahead_mm * ball.ahead,
              reach_mm(geometry(), radius_mm_, max_ahead_mm), share_);
  const double contact_mm2 = std::numbers::pi * radius_mm_ * radius_mm_;
  update_line_share(reach_.pieces().size(), pressed_mm3 / contact_mm2 / geometry().spacing_mm.minCoeff());
  const CutProfile profile = CutProfile::between(static_cast<double>(reach_.floor_density()),
                                                 volume_->isovalue(), densities_.reference);
  voxels_.gather(reach_, ball, profile, max_ahead_mm);
}

// A burr deep in its hole overlaps tens of thousands of voxels and removes a thousandth of each per tick.
// Every second line then takes twice as much every second tick, and so on. Whole lines are skipped because
// they sample the burr evenly.
void BurrMill::update_line_share(std::size_t found, double advance_voxels) {
  pieces_this_round_ += found;
  ++share_.turn;
  const auto may_double = [&](std::size_t all) {
    const bool even = 2 * share_.count * advance_voxels <= kMaxUneven_voxels;
    return share_.count < kMaxShares && all > (even ? kPiecesOfTick : kMaxPiecesOfTick) * share_.count;
  };
  const bool too_many = found > 2 * kPiecesOfTick && may_double(found * share_.count);
  if (!too_many && share_.turn < share_.count) return;
  const std::size_t all = too_many ? found * share_.count : pieces_this_round_;
  share_ = {};
  while (may_double(all)) share_.count *= 2;
  pieces_this_round_ = 0;
}

void BurrMill::count_labels(const LabelMap& labels, const CutVoxels::Row& row) {
  for (std::size_t n = row.begin; n < row.end; ++n) {
    const double drop = static_cast<double>(voxels_.before()[n]) - static_cast<double>(voxels_.after()[n]);
    if (drop > 0) by_label_.add(labels.at({voxels_.columns()[n], row.j, row.k}), drop * mm3_per_density_);
  }
}

MillingStep BurrMill::lower_found(double dropped) {
  MillingStep done;
  done.removed_mm3 = dropped * mm3_per_density_;
  const int* columns = voxels_.columns();
  const float* before = voxels_.before();
  const float* after = voxels_.after();
  for (const CutVoxels::Row& row : voxels_.rows()) {
    std::size_t begin = row.begin, end = row.end;
    while (begin < end && !(after[begin] < before[begin])) ++begin;
    if (begin == end) continue;
    while (!(after[end - 1] < before[end - 1])) --end;
    volume_->lower_row(row.j, row.k, columns + begin, after + begin, end - begin);
    if (volume_->labels()) count_labels(*volume_->labels(), {row.j, row.k, begin, end});
    done.change.voxels.include({columns[begin], row.j, row.k});
    done.change.voxels.include({columns[end - 1], row.j, row.k});
  }
  return done;
}

}  // namespace osteomill
