#include "osteomill/exercise/moments.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/exercise/debriefing.h"
#include "osteomill/exercise/src/exercise_samples.h"
#include "osteomill/recording/replay_recording.h"

namespace osteomill {
namespace {

using namespace testing_support;

/// A session in the target, and then in a groove 9 mm long next to it.
class GrooveMoments : public ::testing::Test {
 protected:
  GrooveMoments() {
    std::vector<Vec3> places = way({0, 0, 2}, {0, 0, -0.4}, 0.004);
    for (const auto& [from, to] : {std::pair{Vec3(0, 0, 2), Vec3(-5, 5, 2)},
                                   {Vec3(-5, 5, 2), Vec3(-5, 5, 0.2)},
                                   {Vec3(-5, 5, 0.2), Vec3(4, 5, 0.2)}}) {
      const std::vector<Vec3> next = way(from, to, 0.0015);
      places.insert(places.end(), next.begin(), next.end());
    }
    recording_ = record_poses(scan_, places, 1);
  }

  Volume scan_ = bone_below_zero(0.5);
  PlacedExercise placed_ =
      place_exercise(exercise_with_target(region_of({BoxShape{{-2, -2, -4}, {2, 2, 0}}})), scan_);
  Recording recording_;
};

TEST_F(GrooveMoments, BeginAtTheTickThatFirstRemovesBoneOutsideTheTarget) {
  // Checks all voxels after every tick.
  std::vector<std::size_t> gone;
  Volume bone = scan_;
  repeat_milling(bone, recording_, [&](std::size_t, const Volume& now, const VolumeChange&) {
    std::size_t count = 0;
    for_each(scan_.geometry().all_voxels(), [&](const VoxelIndex& v) {
      if (scan_.is_bone(v) && !now.is_bone(v) && placed_.is_outside(v)) ++count;
    });
    gone.push_back(count);
  });
  const auto first = std::ranges::find_if(gone, [](std::size_t count) { return count > 0; });
  ASSERT_NE(first, gone.end());
  const Attempt attempt = make_attempt(placed_, scan_, recording_);
  const std::vector<Moment> moments = moments_of(attempt);
  ASSERT_GE(moments.size(), 3u);
  EXPECT_EQ(moments.front().first_tick, static_cast<std::size_t>(first - gone.begin()));
  double removed_mm3 = 0;
  for (std::size_t n = 0; n < moments.size(); ++n) {
    EXPECT_EQ(moments[n].kind, Moment::Kind::outside);
    // Each begins and ends with a tick that removed some, and contains all between.
    const std::size_t from = moments[n].first_tick, to = moments[n].last_tick;
    EXPECT_GT(gone[from], gone[from - 1]);
    EXPECT_GT(gone[to], gone[to - 1]);
    EXPECT_NEAR(moments[n].removed_mm3, 0.125 * static_cast<double>(gone[to] - gone[from - 1]), 1e-9);
    removed_mm3 += moments[n].removed_mm3;
    // The groove is one stroke of 9 mm at 1.5 mm/s.
    if (n == 0) continue;
    EXPECT_NEAR((attempt.ticks[from].burr_W - attempt.ticks[moments[n - 1].first_tick].burr_W).norm(), 3,
                0.6);
    EXPECT_NEAR(burr_speed_mm_s(attempt, from), 1.5, 0.3);
  }
  EXPECT_NEAR(removed_mm3, 0.125 * static_cast<double>(gone.back()), 1e-9);
}

TEST(Spread, MatchesStudentsTPredictionIntervalFromFourValuesUp) {
  // The 97.5th percentiles of Student's t for 3, 4 and 9 degrees of freedom are 3.182, 2.776 and 2.262.
  EXPECT_TRUE(std::isnan(spread_of({1, 2, 3}).width));
  const Spread of_four = spread_of({1, 2, 3, 4}), of_five = spread_of({10, 12, 14, 16, 18});
  EXPECT_DOUBLE_EQ(of_four.mean, 2.5);
  EXPECT_NEAR(of_four.width, 3.182 * std::sqrt(5.0 / 3) * std::sqrt(1.25), 0.01 * of_four.width);
  EXPECT_DOUBLE_EQ(of_five.mean, 14);
  EXPECT_NEAR(of_five.width, 2.776 * std::sqrt(10) * std::sqrt(1.2), 0.005 * of_five.width);
  const Spread of_ten = spread_of({0, 1, 0, 1, 0, 1, 0, 1, 0, 1});
  EXPECT_NEAR(of_ten.width, 2.262 * std::sqrt(2.5 / 9) * std::sqrt(1.1), 0.001 * of_ten.width);
}

}  // namespace
}  // namespace osteomill
