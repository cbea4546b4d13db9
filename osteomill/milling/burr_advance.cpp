#include "osteomill/milling/burr_advance.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

namespace {

// Newton's from the tick before takes two or three; halving alone would take 25.
constexpr int kMaxPasses = 25;
constexpr double kTolerance = 0.01;
constexpr double kNoDistance_mm = 1e-7;
// Of the budget, for what the trailing half overlaps.
constexpr double kMaxTrailing = 0.5;

// All of nothing where there is nothing; a budget may be below zero by what floats rounded before.
double part(double of, double all) {
  const double spent = std::max(of, 0.0);
  return all > spent ? spent / all : 1.0;
}

// Between `low`, where the cost is below the budget, and `high`, where it is above: Newton's place, an end
// that has not been tried, or the middle.
double next_ahead(double ahead, double over, double slope, double low, double high, bool low_tried,
                  bool high_tried) {
  const double newton = slope > 0 ? ahead - over / slope : (over > 0 ? low : high);
  if (newton > low && newton < high) return newton;
  if (newton >= high && !high_tried) return high;
  if (newton <= low && !low_tried) return low;
  return 0.5 * (low + high);
}

}  // namespace

BurrAdvance advance_within(double budget, const CutVoxels& voxels, double start_ahead_mm, double min_ahead_mm,
                           double max_ahead_mm) {
  BurrAdvance advance{std::clamp(start_ahead_mm, min_ahead_mm, max_ahead_mm), {}};
  CutVoxels::Cost cost = voxels.cost(advance.ahead_mm);
  const double trailing = cost.trailing * part(kMaxTrailing * budget, cost.trailing);
  const double leading = budget - trailing;
  double low = min_ahead_mm, high = max_ahead_mm;
  bool low_tried = false, high_tried = false;
  for (int pass = 1; pass < kMaxPasses; ++pass) {
    const double over = cost.leading - leading;
    if (std::abs(over) <= kTolerance * leading) break;
    (over > 0 ? high : low) = advance.ahead_mm;
    (over > 0 ? high_tried : low_tried) = true;
    if (high - low < kNoDistance_mm) break;
    advance.ahead_mm =
        next_ahead(advance.ahead_mm, over, cost.slope_per_mm, low, high, low_tried, high_tried);
    cost = voxels.cost(advance.ahead_mm);
  }
  advance.shares.leading = part(leading, cost.leading);
  advance.shares.trailing = part(budget - advance.shares.leading * cost.leading, cost.trailing);
  return advance;
}

}  // namespace osteomill
