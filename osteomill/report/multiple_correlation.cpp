#include "osteomill/report/multiple_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace osteomill {

namespace {

// Of the leader's samples: five, evenly spread from `reach` before to `reach` after.
constexpr std::size_t kLags = 5;
constexpr std::size_t kSamplesEach = 20;
using Leading = Eigen::Matrix<double, 3 * kLags, 1>;

Leading leading_at(std::span<const Vec3> leader, std::size_t n, std::size_t reach) {
  Leading values;
  for (std::size_t lag = 0; lag < kLags; ++lag) {
    values.segment<3>(static_cast<Eigen::Index>(3 * lag)) = leader[n - reach + 2 * reach * lag / (kLags - 1)];
  }
  return values;
}

}  // namespace

double multiple_correlation(std::span<const Vec3> follower, std::span<const Vec3> leader, std::size_t reach,
                            const std::vector<bool>& counted) {
  Eigen::Matrix<double, 3 * kLags, 3 * kLags> squares = decltype(squares)::Zero();
  Eigen::Matrix<double, 3 * kLags, 3> products = decltype(products)::Zero();
  double follower_squares = 0;
  std::size_t count = 0;
  for (std::size_t n = reach; n + reach < follower.size(); ++n) {
    if (!counted[n]) continue;
    const Leading values = leading_at(leader, n, reach);
    squares += values * values.transpose();
    products += values * follower[n].transpose();
    follower_squares += follower[n].squaredNorm();
    ++count;
  }
  const double scale = squares.trace();
  if (count < kSamplesEach * 3 * kLags || !(scale > 0) || !(follower_squares > 0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  // Signals that lie in a plane or are slow against the lags leave the system singular.
  squares.diagonal().array() += 1e-9 * scale;
  const double explained = squares.ldlt().solve(products).cwiseProduct(products).sum();
  return std::sqrt(std::clamp(explained / follower_squares, 0.0, 1.0));
}

}  // namespace osteomill
