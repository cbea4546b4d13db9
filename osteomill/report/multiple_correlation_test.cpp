#include "osteomill/report/multiple_correlation.h"

#include <cmath>

#include "tests/random.h"
#include <gtest/gtest.h>

namespace osteomill {
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

TEST(MultipleCorrelation, IsOneWhereAFilterOfTheLeaderIsFollowedAndNearNothingForStrangers) {
  const std::vector<Vec3> leader = noise(1);
  std::vector<Vec3> late(leader.size(), Vec3::Zero());
  for (std::size_t n = 2; n < leader.size(); ++n) {
    late[n] = Vec3(0, 0, 3).cross(leader[n - 2]) - 0.4 * leader[n];
  }
  EXPECT_NEAR(follows(late, leader), 1, 1e-6);
  // By chance alone 15 coefficients explain 15 / 5000 of the squares.
  EXPECT_NEAR(follows(noise(2), leader), std::sqrt(15.0 / 5000), 0.02);
}

TEST(MultipleCorrelation, SaysWhatShareIsFollowed) {
  const std::vector<Vec3> leader = noise(1), other = noise(2);
  std::vector<Vec3> mixed;
  for (std::size_t n = 0; n < leader.size(); ++n) mixed.push_back(0.6 * leader[n] + 0.8 * other[n]);
  EXPECT_NEAR(follows(mixed, leader), 0.6, 0.02);
}

TEST(MultipleCorrelation, LooksOnlyAtWhatIsCountedAndSaysNothingOfTooLittle) {
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
