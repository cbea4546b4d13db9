#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/session/hand.h"

namespace osteomill {
namespace {

constexpr double kRms_mm = 0.02;

TEST(Tremor, HasTheRequestedRmsAlongEachAxis) {
  for (std::uint64_t seed : {1u, 2u, 77u}) {
    const Tremor tremor(seed, kRms_mm);
    Vec3 sum = Vec3::Zero();
    Vec3 sum_of_squares = Vec3::Zero();
    constexpr int kSamples = 100000;
    for (int n = 0; n < kSamples; ++n) {
      const Vec3 x = tremor.at(n * 1e-3);
      sum += x;
      sum_of_squares += x.cwiseProduct(x);
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(std::sqrt(sum_of_squares[axis] / kSamples), kRms_mm, 0.05 * kRms_mm);
      EXPECT_NEAR(sum[axis] / kSamples, 0, 0.01 * kRms_mm);
    }
  }
}

// Returns the power in a band by a plain Fourier sum, independent of the implementation.
double power_between(const std::vector<double>& signal, double rate_hz, double lowest_hz, double highest_hz) {
  const double length_s = static_cast<double>(signal.size()) / rate_hz;
  double power = 0;
  for (int bin = static_cast<int>(lowest_hz * length_s); bin < static_cast<int>(highest_hz * length_s);
       ++bin) {
    double cosine = 0;
    double sine = 0;
    for (std::size_t n = 0; n < signal.size(); ++n) {
      const double angle = 2 * M_PI * bin * static_cast<double>(n) / static_cast<double>(signal.size());
      cosine += signal[n] * std::cos(angle);
      sine += signal[n] * std::sin(angle);
    }
    power += 2 * (cosine * cosine + sine * sine) / std::pow(static_cast<double>(signal.size()), 2);
  }
  return power;
}

TEST(Tremor, HasMostPowerFrom8To12HzAndAlmostNoneAbove32Hz) {
  const Tremor tremor(5, kRms_mm);
  constexpr double kRate_hz = 100;
  std::vector<double> signal;
  for (int n = 0; n < 2000; ++n) signal.push_back(tremor.at(n / kRate_hz).x());
  const double all = kRms_mm * kRms_mm;
  EXPECT_GT(power_between(signal, kRate_hz, 7.5, 12.5), 0.80 * all);
  EXPECT_GT(power_between(signal, kRate_hz, 14, 31), 0.02 * all);
  EXPECT_LT(power_between(signal, kRate_hz, 32, 50), 0.01 * all);
}

TEST(Tremor, IsBitIdenticalForTheSameSeedAndDiffersForAnother) {
  const Tremor one(9, kRms_mm);
  const Tremor same(9, kRms_mm);
  const Tremor other(10, kRms_mm);
  double difference = 0;
  for (int n = 0; n < 1000; ++n) {
    ASSERT_EQ(one.at(n * 1e-3), same.at(n * 1e-3));
    difference += (one.at(n * 1e-3) - other.at(n * 1e-3)).norm();
  }
  EXPECT_GT(difference / 1000, 0.5 * kRms_mm);
}

// The value at a time does not depend on the sampling rate or order.
TEST(Tremor, DoesNotDependOnSamplingRateOrOrder) {
  const Tremor tremor(3, kRms_mm);
  std::vector<Vec3> fine;
  for (int n = 0; n < 2000; ++n) fine.push_back(tremor.at(n * 1e-3));
  for (int n = 399; n >= 0; --n) {
    EXPECT_EQ(tremor.at((5 * n) * 1e-3), fine[static_cast<std::size_t>(5 * n)]);
  }
}

TEST(Tremor, MovesSlowerThan12MillimetresPerSecond) {
  const Tremor tremor(4, kRms_mm);
  double fastest_mm_s = 0;
  for (int n = 0; n < 60000; ++n) {
    fastest_mm_s = std::max(fastest_mm_s, (tremor.at((n + 1) * 1e-3) - tremor.at(n * 1e-3)).norm() / 1e-3);
  }
  EXPECT_GT(fastest_mm_s, 1.0);
  EXPECT_LT(fastest_mm_s, 12.0);
}

TEST(Tremor, IsExactlyZeroForZeroRms) {
  EXPECT_EQ(Tremor(1, 0.0).at(0.123), Vec3::Zero());
}

TEST(Tremor, RefusesANegativeOrInfiniteRms) {
  EXPECT_THROW(Tremor(1, -0.01), std::invalid_argument);
  EXPECT_THROW(Tremor(1, std::numeric_limits<double>::infinity()), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
