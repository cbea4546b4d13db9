#include "osteomill/milling/cut_voxels.h"

#include <algorithm>
#include <cmath>

#include "cut_kernel.h"

namespace osteomill {

namespace {

constexpr std::size_t kLanes = CutLists::kLanes;
// Number of drops summed in float before the sum is added to a double.
constexpr std::size_t kBlock = 64 * kLanes;

double sum_of(const float (&lanes)[kLanes]) {
  double sum = 0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

CutKernelBall kernel_ball(const CuttingBall& ball, const Vec3& spacing_mm) {
  const Eigen::Vector3f ahead = ball.ahead.cast<float>(), spacing = spacing_mm.cast<float>();
  return {static_cast<float>(ball.radius_mm),
          {ahead.x(), ahead.y(), ahead.z()},
          {spacing.x(), spacing.y(), spacing.z()},
          spacing_mm.maxCoeff() - spacing_mm.minCoeff() < 1e-6 * spacing_mm.maxCoeff()};
}

// Writes a padding entry, which costs nothing.
void write_padding(CutLists& lists, std::size_t n, float surroundings) {
  lists.distance2_mm2[n] = 1;
  lists.ahead_mm[n] = 0;
  lists.voxels_per_mm[n] = 1;
  lists.before[n] = surroundings;
}

// Newton's method started from the last tick takes two or three passes; bisection alone takes 25.
constexpr int kMaxPasses = 25;
constexpr double kTolerance = 0.01;
constexpr double kMinInterval_mm = 1e-7;
// Maximum fraction of the budget for the trailing half.
constexpr double kMaxTrailing = 0.5;

// Returns `of` / `all`, clamped to [0, 1]; 1 if `all` is 0. `of` may be slightly negative by float rounding.
double clamped_ratio(double of, double all) {
  const double spent = std::max(of, 0.0);
  return all > spent ? spent / all : 1.0;
}

// Returns the next advance to try between `low` (cost below the budget) and `high` (above): the Newton step,
// an untried end, or the midpoint.
double next_ahead(double ahead, double over, double slope, double low, double high, bool low_tried,
                  bool high_tried) {
  const double newton = slope > 0 ? ahead - over / slope : (over > 0 ? low : high);
  if (newton > low && newton < high) return newton;
  if (newton >= high && !high_tried) return high;
  if (newton <= low && !low_tried) return low;
  return 0.5 * (low + high);
}

}  // namespace

CutVoxels::CutVoxels(const GridGeometry& geometry, std::size_t voxels, std::size_t rows)
    : geometry_(geometry) {
  choose_cut_instructions();
  const std::size_t room = voxels + 2 * kLanes;
  for (std::vector<float>* list :
       {&lists_.distance2_mm2, &lists_.ahead_mm, &lists_.voxels_per_mm, &lists_.before, &lists_.after}) {
    list->resize(room);
  }
  lists_.columns.resize(room);
  rows_.reserve(rows);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    from_centre_mm_[axis].resize(static_cast<std::size_t>(geometry.dims[axis]) + kLanes);
  }
}

// Computes the distances of the voxel planes near the ball from its centre.
void CutVoxels::measure(const CuttingBall& ball, double reach_mm) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const double spacing_mm = geometry_.spacing_mm[at], centre_mm = ball.centre_mm[at];
    std::vector<float>& planes = from_centre_mm_[axis];
    const double count = static_cast<double>(planes.size());
    // A brick's row may begin up to one brick earlier.
    const double first = std::clamp((centre_mm - reach_mm) / spacing_mm - kLanes, 0.0, count);
    const double last = std::clamp((centre_mm + reach_mm) / spacing_mm + kLanes + 1, 0.0, count);
    for (auto n = static_cast<std::size_t>(first); n < static_cast<std::size_t>(last); ++n) {
      planes[n] = static_cast<float>(static_cast<double>(n) * spacing_mm - centre_mm);
    }
  }
}

void CutVoxels::gather(BurrReach& reach, const CuttingBall& ball, const CutProfile& profile,
                       double max_ahead_mm) noexcept {
  radius_mm_ = static_cast<float>(ball.radius_mm);
  profile_ = profile;
  rows_.clear();
  lists_.size = 0;
  measure(ball, ball.radius_mm + max_ahead_mm + CutProfile::kReach_voxels * geometry_.spacing_mm.maxCoeff());
  const CutKernelBall kernel = kernel_ball(ball, geometry_.spacing_mm);
  for (const BurrReach::Piece& piece : reach.pieces()) {
    const auto& [i, j, k] = piece.first;
    const std::size_t begin = lists_.size;
    const unsigned denser = gather_piece({piece.densities, &from_centre_mm_[0][static_cast<std::size_t>(i)],
                                          from_centre_mm_[1][static_cast<std::size_t>(j)],
                                          from_centre_mm_[2][static_cast<std::size_t>(k)], i, piece.bits},
                                         kernel, profile, static_cast<float>(max_ahead_mm), lists_);
    if (lists_.size > begin) rows_.push_back({j, k, begin, lists_.size});
    if (denser != piece.bits) reach.forget_voxels(piece, piece.bits & ~denser);
  }
  for (std::size_t n = 0; n < kLanes; ++n) write_padding(lists_, lists_.size + n, profile.surroundings);
}

CutVoxels::Cost CutVoxels::cost(double ahead_mm) const noexcept {
  Cost cost;
  const std::size_t end = (lists_.size + kLanes - 1) / kLanes * kLanes;
  for (std::size_t begin = 0; begin < end; begin += kBlock) {
    CutSums sums;
    sum_drops(lists_, begin, std::min(begin + kBlock, end), radius_mm_, profile_,
              static_cast<float>(ahead_mm), sums);
    cost.leading += sum_of(sums.leading);
    cost.slope_per_mm += sum_of(sums.slope);
    cost.trailing += sum_of(sums.trailing);
  }
  return cost;
}

double CutVoxels::find_lowered(double ahead_mm, const Shares& shares) noexcept {
  lower_densities(lists_, radius_mm_, profile_, static_cast<float>(ahead_mm),
                  static_cast<float>(shares.leading), static_cast<float>(shares.trailing));
  double dropped = 0;
  for (std::size_t n = 0; n < lists_.size; ++n) {
    dropped += static_cast<double>(lists_.before[n]) - static_cast<double>(lists_.after[n]);
  }
  return dropped;
}

BurrAdvance advance_within(double budget, const CutVoxels& voxels, double start_ahead_mm, double min_ahead_mm,
                           double max_ahead_mm) noexcept {
  BurrAdvance advance{std::clamp(start_ahead_mm, min_ahead_mm, max_ahead_mm), {}, 0};
  CutVoxels::Cost cost = voxels.cost(advance.ahead_mm);
  const double trailing = cost.trailing * clamped_ratio(kMaxTrailing * budget, cost.trailing);
  const double leading = budget - trailing;
  double low = min_ahead_mm, high = max_ahead_mm;
  bool low_tried = false, high_tried = false;
  for (int pass = 1; pass < kMaxPasses; ++pass) {
    const double over = cost.leading - leading;
    if (std::abs(over) <= kTolerance * leading) break;
    (over > 0 ? high : low) = advance.ahead_mm;
    (over > 0 ? high_tried : low_tried) = true;
    if (high - low < kMinInterval_mm) break;
    advance.ahead_mm =
        next_ahead(advance.ahead_mm, over, cost.slope_per_mm, low, high, low_tried, high_tried);
    cost = voxels.cost(advance.ahead_mm);
  }
  advance.slope_per_mm = cost.slope_per_mm;
  advance.shares.leading = clamped_ratio(leading, cost.leading);
  advance.shares.trailing = clamped_ratio(budget - advance.shares.leading * cost.leading, cost.trailing);
  return advance;
}

}  // namespace osteomill
