#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_session.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

std::vector<TrajectoryPoint> down_onto_the_plane(bool milling) {
  std::vector<TrajectoryPoint> trajectory;
  for (int n = 0; n < 800; ++n) {
    trajectory.push_back({n * 1e-3, {{0, 0, 2.0 - 0.0025 * n}, Quat::Identity()}, milling});
  }
  return trajectory;
}

std::vector<TickRecord> replayed(bool milling) {
  Volume bone = testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                              testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  MillingSession session(
      std::make_shared<Volume>(std::move(bone)), {0, 1000},
      {.algorithm = algorithm_named("point-shell"), .guard = GuardSettings::for_simulation()});
  std::vector<TickRecord> log;
  replay(session, down_onto_the_plane(milling), [&](const TickRecord& record) { log.push_back(record); });
  return log;
}

TEST(Replay, GivesOneTickPerRowWithItsTimeAndPose) {
  const auto log = replayed(false);
  ASSERT_EQ(log.size(), 800u);
  EXPECT_EQ(log[300].time_s, 300 * 1e-3);
  EXPECT_EQ(log[300].X_WD.position_mm.z(), 2.0 - 0.0025 * 300);
  EXPECT_EQ(log[0].wrench.force_N, Vec3::Zero());
  EXPECT_GT(log.back().wrench.force_N.z(), 0.1);
}

TEST(Replay, RemovesBoneOnlyIfTheTrajectoryIsMilling) {
  EXPECT_EQ(replayed(false).back().removed_mm3, 0);
  EXPECT_GT(replayed(true).back().removed_mm3, 0);
}

TEST(Replay, SecondReplayIsBitIdentical) {
  const auto first = replayed(true);
  const auto second = replayed(true);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t n = 0; n < first.size(); ++n) {
    EXPECT_EQ(first[n].wrench.force_N, second[n].wrench.force_N);
    EXPECT_EQ(first[n].wrench.torque_Nmm, second[n].wrench.torque_Nmm);
    EXPECT_EQ(first[n].removed_mm3, second[n].removed_mm3);
  }
}

}  // namespace
}  // namespace osteomill
