#include "report/signals.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace osteomill {

namespace {

constexpr double kRate_hz = 1000;

std::vector<Vec3> sine(double hz, const Vec3& amplitude, const Vec3& offset = Vec3::Zero(),
                       int count = 4000) {
  std::vector<Vec3> samples;
  for (int n = 0; n < count; ++n) {
    samples.push_back(offset + std::sin(2 * std::numbers::pi * hz * n / kRate_hz) * amplitude);
  }
  return samples;
}

double max_inside(const std::vector<Vec3>& samples) {
  double max = 0;
  for (std::size_t n = 500; n + 500 < samples.size(); ++n) max = std::max(max, samples[n].norm());
  return max;
}

TEST(HighPass, RemovesASlowSine) {
  EXPECT_LT(max_inside(high_pass(sine(5, {1, 0, 0}), kRate_hz, 20)), 0.01);
}

TEST(HighPass, KeepsAFastSineWithoutPhaseShift) {
  const auto in = sine(100, {3, -2, 1}, {10, 20, 30});
  const auto out = high_pass(in, kRate_hz, 20);
  for (std::size_t n = 500; n + 500 < in.size(); ++n) {
    ASSERT_LT((out[n] - (in[n] - Vec3(10, 20, 30))).norm(), 0.002 * Vec3(3, -2, 1).norm()) << n;
  }
}

TEST(HighPass, PassesHalfThePowerAtTheCutoff) {
  EXPECT_NEAR(max_inside(high_pass(sine(20, {0, 1, 0}), kRate_hz, 20)), std::sqrt(0.5), 0.002);
}

// The ends must not ring, or every recording that starts under load would look unsteady.
TEST(HighPass, RemovesAConstantAndARampUpToTheEnds) {
  std::vector<Vec3> ramp;
  for (int n = 0; n < 3000; ++n) ramp.emplace_back(100 + 0.01 * n, -7, 3 - 0.02 * n);
  for (const Vec3& sample : high_pass(ramp, kRate_hz, 20)) ASSERT_LT(sample.norm(), 0.05);
  for (const Vec3& sample : high_pass(std::vector<Vec3>(50, Vec3(1, 2, 3)), kRate_hz, 20)) {
    ASSERT_LT(sample.norm(), 1e-12);
  }
}

TEST(HighPass, IsSymmetricInTime) {
  auto in = sine(33, {1, 0, 0}, {0, 0, 0}, 777);
  auto out = high_pass(in, kRate_hz, 20);
  std::reverse(in.begin(), in.end());
  const auto backwards = high_pass(in, kRate_hz, 20);
  std::reverse(out.begin(), out.end());
  for (std::size_t n = 200; n + 200 < out.size(); ++n) ASSERT_LT((out[n] - backwards[n]).norm(), 1e-4) << n;
}

TEST(HighPass, AcceptsFewSamplesAndRefusesImpossibleCutoffs) {
  EXPECT_TRUE(high_pass({}, kRate_hz, 20).empty());
  EXPECT_EQ(high_pass(std::vector{Vec3(1, 2, 3)}, kRate_hz, 20).at(0), Vec3::Zero());
  EXPECT_EQ(high_pass(std::vector<Vec3>(2, Vec3::Ones()), kRate_hz, 20).size(), 2u);
  EXPECT_THROW(high_pass({}, 40, 20), std::invalid_argument);
  EXPECT_THROW(high_pass({}, 1000, 0), std::invalid_argument);
}

}  // namespace

namespace {

constexpr std::size_t kReach = 4;

std::vector<Vec3> noise(unsigned seed, std::size_t count = 5000) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3> samples(count);
  for (Vec3& sample : samples) sample = {normal(random), normal(random), normal(random)};
  return samples;
}

double follows(const std::vector<Vec3>& follower, const std::vector<Vec3>& leader) {
  return multiple_correlation(follower, leader, kReach, std::vector<bool>(leader.size(), true));
}

TEST(MultipleCorrelation, IsOneForAFilteredLeaderAndNearZeroForNoise) {
  const std::vector<Vec3> leader = noise(1);
  std::vector<Vec3> late(leader.size(), Vec3::Zero());
  for (std::size_t n = 2; n < leader.size(); ++n) {
    late[n] = Vec3(0, 0, 3).cross(leader[n - 2]) - 0.4 * leader[n];
  }
  EXPECT_NEAR(follows(late, leader), 1, 1e-6);
  // By chance alone, 15 coefficients explain 15 / 5000 of the squares.
  EXPECT_NEAR(follows(noise(2), leader), std::sqrt(15.0 / 5000), 0.02);
}

TEST(MultipleCorrelation, EqualsTheLeadersShareOfAMixture) {
  const std::vector<Vec3> leader = noise(1), other = noise(2);
  std::vector<Vec3> mixed;
  for (std::size_t n = 0; n < leader.size(); ++n) mixed.push_back(0.6 * leader[n] + 0.8 * other[n]);
  EXPECT_NEAR(follows(mixed, leader), 0.6, 0.02);
}

TEST(MultipleCorrelation, UsesOnlyCountedSamplesAndIsNanForTooFewOrZero) {
  const std::vector<Vec3> leader = noise(1);
  std::vector<Vec3> follower = leader;
  std::vector<bool> counted(leader.size(), true);
  for (std::size_t n = 1000; n < 4000; ++n) follower[n] = Vec3::Zero(), counted[n] = false;
  EXPECT_NEAR(multiple_correlation(follower, leader, kReach, counted), 1, 1e-6);
  EXPECT_TRUE(std::isnan(follows(noise(1, 300), noise(1, 300))));
  EXPECT_TRUE(std::isnan(follows(std::vector<Vec3>(leader.size(), Vec3::Zero()), leader)));
}

}  // namespace

}  // namespace osteomill
