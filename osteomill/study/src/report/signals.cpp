#include "report/signals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace osteomill {

namespace {

// Two passes of |H|^2 = w^4 / (1 + w^4) halve the power at w^4 = 1 + sqrt(2), so the cutoff of each pass is
// lower by this factor.
const double kBothPasses = std::pow(1.0 + std::numbers::sqrt2, 0.25);

struct Biquad {
  double b0, b1, b2, a1, a2;
};

Biquad butterworth_high_pass(double rate_hz, double cutoff_hz) {
  const double k = std::tan(std::numbers::pi * cutoff_hz / rate_hz);
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  return {scale, -2.0 * scale, scale, 2.0 * (k * k - 1.0) * scale,
          (1.0 - std::numbers::sqrt2 * k + k * k) * scale};
}

void filter_in_place(const Biquad& f, std::vector<Vec3>& samples) {
  // Steady state for a constant input equal to the first sample, whose output is zero.
  Vec3 z1 = -f.b0 * samples.front();
  Vec3 z2 = f.b2 * samples.front();
  for (Vec3& sample : samples) {
    const Vec3 in = sample;
    sample = f.b0 * in + z1;
    z1 = f.b1 * in - f.a1 * sample + z2;
    z2 = f.b2 * in - f.a2 * sample;
  }
}

}  // namespace

std::vector<Vec3> high_pass(std::span<const Vec3> samples, double rate_hz, double cutoff_hz) {
  if (!(cutoff_hz > 0 && cutoff_hz < 0.4 * rate_hz)) {
    throw std::invalid_argument("the cutoff of a high pass must lie below 0.4 of the sampling rate");
  }
  if (samples.size() < 2) return std::vector<Vec3>(samples.size(), Vec3::Zero());
  const auto settle = static_cast<std::size_t>(std::ceil(3.0 * rate_hz / cutoff_hz));
  const std::size_t pad = std::min(settle, samples.size() - 1);
  std::vector<Vec3> padded;
  padded.reserve(samples.size() + 2 * pad);
  for (std::size_t n = pad; n > 0; --n) padded.push_back(2.0 * samples.front() - samples[n]);
  padded.insert(padded.end(), samples.begin(), samples.end());
  for (std::size_t n = 1; n <= pad; ++n)
    padded.push_back(2.0 * samples.back() - samples[samples.size() - 1 - n]);

  const Biquad filter = butterworth_high_pass(rate_hz, cutoff_hz / kBothPasses);
  filter_in_place(filter, padded);
  std::reverse(padded.begin(), padded.end());
  filter_in_place(filter, padded);
  std::reverse(padded.begin(), padded.end());
  const auto first = padded.begin() + static_cast<std::ptrdiff_t>(pad);
  return std::vector<Vec3>(first, first + static_cast<std::ptrdiff_t>(samples.size()));
}

namespace {

// Number of the leader's samples per fit, evenly spread from `reach` before to `reach` after.
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
  // Planar signals, or ones slow compared with the lags, make the system singular.
  squares.diagonal().array() += 1e-9 * scale;
  const double explained = squares.ldlt().solve(products).cwiseProduct(products).sum();
  return std::sqrt(std::clamp(explained / follower_squares, 0.0, 1.0));
}

}  // namespace osteomill
