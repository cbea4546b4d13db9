#include "osteomill/study/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/study/metric_table.h"

namespace osteomill {
namespace {

constexpr double kPi = std::numbers::pi;

// 3 N in a slowly turning direction, plus 0.2 N at 100 Hz.
TEST(VectorMetrics, MatchesAnalyticFiguresOfASteadyForceWithABuzz) {
  std::vector<Vec3> force;
  for (int n = 0; n < 10000; ++n) {
    const double t = 0.001 * n;
    force.push_back(Vec3(3 * std::cos(t), 3 * std::sin(t), 0.2 * std::sin(2 * kPi * 100 * t)));
  }
  const VectorMetrics m = vector_metrics(force, 1000);
  EXPECT_NEAR(m.hp_rms, 0.2 / std::sqrt(2.0), 0.001);
  EXPECT_NEAR(m.mean, 3 + 0.02 / (2 * 3), 1e-3);
  EXPECT_NEAR(m.max, std::hypot(3, 0.2 * std::sin(0.4 * kPi)), 1e-4);
  EXPECT_NEAR(m.step_max, 0.2 * 2 * std::sin(0.1 * kPi), 0.01);
}

// The magnitude stays the same; only the vector difference shows the jump.
TEST(VectorMetrics, CountsAReversalOfDirectionAsAStep) {
  std::vector<Vec3> force(1000, Vec3(0, 0, 2));
  for (std::size_t n = 500; n < force.size(); ++n) force[n] = {0, 0, -2};
  EXPECT_DOUBLE_EQ(vector_metrics(force, 1000).step_max, 4);
  EXPECT_DOUBLE_EQ(vector_metrics(force, 1000).mean, 2);
}

// Directions on a cone of 2 degrees about any axis: each deviates by 2 degrees.
TEST(DirectionMetrics, SpreadAndExcursionOfAConeAreItsHalfAngle) {
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 2, -0.5)}) {
    const Quat turn = smallest_rotation(Vec3::UnitZ(), axis);
    std::vector<Vec3> directions;
    const double angle = 2 * kPi / 180;
    for (int n = 0; n < 360; ++n) {
      const double a = n * kPi / 180;
      directions.push_back(
          turn * Vec3(std::sin(angle) * std::cos(a), std::sin(angle) * std::sin(a), std::cos(angle)));
    }
    const DirectionMetrics m = direction_metrics(directions);
    EXPECT_NEAR(m.spread_deg, 2, 1e-9);
    EXPECT_NEAR(m.excursion_deg, 2, 1e-9);
  }
}

TEST(DirectionMetrics, SpreadOfASineIsItsRmsAndExcursionItsAmplitude) {
  std::vector<Vec3> directions;
  for (int n = 0; n < 1000; ++n) {
    const double angle = 1e-3 * std::sin(2 * kPi * n / 1000);
    directions.emplace_back(std::sin(angle), 0, std::cos(angle));
  }
  const double degrees = 180 / kPi;
  EXPECT_NEAR(direction_metrics(directions).spread_deg, 1e-3 / std::sqrt(2.0) * degrees, 1e-8);
  EXPECT_NEAR(direction_metrics(directions).excursion_deg, 1e-3 * degrees, 1e-8);
}

Recording simple_recording(int ticks) {
  Recording recording;
  recording.path = "some/run.h5";
  for (int n = 0; n < ticks; ++n) {
    TickRecord r;
    r.time_s = 0.001 * n;
    r.wrench = {{1, 2, 2}, {0, 6, 8}};
    r.compute_us = n < ticks / 2 ? 800 : 10;
    r.milling_us = 1200;
    r.removed_mm3 = 5 + 0.25 * n;
    recording.records.push_back(r);
  }
  return recording;
}

TEST(RunMetrics, ComputesTimesForcesAndRemovalOfARecording) {
  const RunMetrics m = run_metrics(simple_recording(1000));
  EXPECT_EQ(m.steps, 1000);
  EXPECT_DOUBLE_EQ(m.step_us.max, 800);
  EXPECT_DOUBLE_EQ(m.step_us.median, 405);
  EXPECT_NEAR(m.rate_hz, 1e6 / (0.5 * (2000 + 1210)), 1e-9);
  EXPECT_DOUBLE_EQ(m.force_N.mean, 3);
  EXPECT_DOUBLE_EQ(m.torque_Nmm.max, 10);
  EXPECT_NEAR(m.force_N.hp_rms, 0, 1e-12);
  EXPECT_DOUBLE_EQ(m.removed_mm3, 0.25 * 999);
}

// Preemption lengthens a tick's wall-clock time, not its CPU time.
TEST(RunMetrics, RateUsesTheThreadsCpuTimeIfRecorded) {
  Recording preempted = simple_recording(1000);
  EXPECT_DOUBLE_EQ(run_metrics(preempted).tick_us.max, 2000) << "by the clock";
  for (TickRecord& record : preempted.records) record.tick_cpu_us = record.time_s < 0.5 ? 100 : 1250;
  const RunMetrics m = run_metrics(preempted);
  EXPECT_DOUBLE_EQ(m.tick_us.median, 675);
  EXPECT_DOUBLE_EQ(m.tick_us.max, 1250);
  EXPECT_NEAR(m.rate_hz, 1e6 / (0.5 * (1000 + 1250)), 1e-9);
}

TEST(RunMetrics, PathLengthExcludesTremor) {
  Recording moving = simple_recording(1001);
  for (std::size_t n = 0; n < moving.records.size(); ++n) {
    moving.records[n].X_WT.position_mm = {0.01 * static_cast<double>(n), n % 2 == 0 ? 0.0 : 0.05, 0};
  }
  EXPECT_NEAR(run_metrics(moving).path_mm, 10, 0.25);
}

TEST(RunMetrics, BurrExcursionExcludesBuzzingInPlace) {
  Recording moving = simple_recording(1000);
  for (std::size_t n = 0; n < moving.records.size(); ++n)
    moving.records[n].X_WT.position_mm = {n % 40 < 20 ? 0.3 : -0.3, 0, 0};
  EXPECT_NEAR(run_metrics(moving).burr_excursion_mm, 0, 0.08);
  // The position in the second half of the time is 0.5 mm from the mean.
  for (std::size_t n = 500; n < 1000; ++n) moving.records[n].X_WT.position_mm.z() = 1;
  EXPECT_NEAR(run_metrics(moving).burr_excursion_mm, 0.5, 0.01);
}

// Handle and tool tilt by 20 degrees together; then, half of the time, the tool tilts 2 degrees less than the
// handle.
TEST(RunMetrics, SpreadFromTheHandleExcludesTheCommandedLean) {
  Recording leaning = simple_recording(1000);
  const auto leant = [](double degrees) {
    return quaternion_from_rotation_vector({degrees * kPi / 180, 0, 0});
  };
  for (std::size_t n = 0; n < 1000; ++n) {
    TickRecord& record = leaning.records[n];
    record.wrench.torque_Nmm = {1, 0, 0};
    record.X_WD.orientation = record.X_WT.orientation = leant(0.02 * static_cast<double>(n));
  }
  EXPECT_NEAR(run_metrics(leaning).shaft_from_handle_deg, 0, 1e-6);
  EXPECT_GT(run_metrics(leaning).shaft.spread_deg, 5);
  for (std::size_t n = 0; n < 1000; n += 2)
    leaning.records[n].X_WT.orientation = leant(0.02 * static_cast<double>(n) - 2);
  EXPECT_NEAR(run_metrics(leaning).shaft_from_handle_deg, 1, 1e-6);
}

TEST(RunMetrics, RemovalRateCountsOnlyTheTimeOfCutting) {
  Recording cutting = simple_recording(1000);
  for (std::size_t n = 0; n < 1000; ++n) {
    TickRecord& record = cutting.records[n];
    record.dt_s = 1e-3;
    record.spindle_on = n < 500;
    record.burr_force_W_N = {0, 0, n < 250 ? 1.0 : 0.0};
    record.removed_mm3 = 0.004 * static_cast<double>(std::min<std::size_t>(n, 250));
  }
  EXPECT_NEAR(run_metrics(cutting).removal_mm3_per_s, 4, 0.02);
  for (TickRecord& record : cutting.records) record.spindle_on = false;
  EXPECT_TRUE(std::isnan(run_metrics(cutting).removal_mm3_per_s));
}

// Mills five mm^3, undoes and redoes it, and mills three more.
TEST(RunMetrics, CountsARedoneCutOnlyOnce) {
  Recording recording = simple_recording(1000);
  for (std::size_t n = 0; n < 1000; ++n) {
    TickRecord& record = recording.records[n];
    const std::size_t session = std::min<std::size_t>(n / 250, 2);
    const double more_mm3 = std::clamp(0.02 * (static_cast<double>(n) - 600), 0.0, 3.0);
    record.session = static_cast<std::uint32_t>(session);
    record.spindle_on = n < 200 || n >= 500;
    record.removed_mm3 = session == 0 ? std::min(5.0, 0.1 * static_cast<double>(n)) : 0;
    if (session == 2) record.removed_mm3 = 5 + more_mm3;
  }
  EXPECT_NEAR(run_metrics(recording).put_back_mm3, 0, 1e-12);
  EXPECT_NEAR(run_metrics(recording).removed_mm3, 8, 1e-12);
  recording.records.resize(500);
  EXPECT_NEAR(run_metrics(recording).put_back_mm3, 5, 1e-12);
  EXPECT_NEAR(run_metrics(recording).removed_mm3, 5, 1e-12);
}

// Free air before and after changes only the contact shares: felt quantities are measured in contact.
TEST(RunMetrics, ExcludesFreeAirFromForceAndTorque) {
  const RunMetrics touching = run_metrics(simple_recording(4000));
  Recording longer = simple_recording(10000);
  for (std::size_t n = 4000; n < 10000; ++n) longer.records[n].wrench = {};
  const RunMetrics m = run_metrics(longer);
  EXPECT_DOUBLE_EQ(m.contact.any, 0.4);
  EXPECT_DOUBLE_EQ(m.contact.shaft, 0.4);
  EXPECT_EQ(m.contact.burr, 0);
  EXPECT_EQ(contact_words(m.contact), "lost contact after 4.0 s");
  EXPECT_DOUBLE_EQ(m.force_N.mean, touching.force_N.mean);
  EXPECT_DOUBLE_EQ(m.torque_Nmm.mean, touching.torque_Nmm.mean);
  EXPECT_DOUBLE_EQ(m.force_N.step_max, 3) << "letting go is felt";
  EXPECT_FALSE(touching.contact.is_lost());
}

// A pressed burr has no torque to be steady, and a shaft without contact has no direction of its own.
TEST(RunMetrics, MeasuresForceAndTorqueOnlyIfEachIsFelt) {
  Recording burr_alone = simple_recording(4000);
  for (TickRecord& record : burr_alone.records) record.wrench.torque_Nmm *= 1e-6;
  const RunMetrics m = run_metrics(burr_alone);
  EXPECT_EQ(contact_words(m.contact), "the shaft touched for less than 1 % of the time");
  EXPECT_DOUBLE_EQ(m.force_N.mean, 3);
  EXPECT_TRUE(std::isnan(m.torque_Nmm.hp_rms) && std::isnan(m.shaft.spread_deg));

  Recording torque_alone = simple_recording(4000);
  for (TickRecord& record : torque_alone.records) record.wrench.force_N.setZero();
  const RunMetrics of_torque = run_metrics(torque_alone);
  EXPECT_EQ(contact_words(of_torque.contact), "felt a force for less than 1 % of the time");
  EXPECT_TRUE(std::isnan(of_torque.force_N.mean));
  EXPECT_FALSE(std::isnan(of_torque.torque_Nmm.mean) || std::isnan(of_torque.shaft.spread_deg));
}

TEST(ContactWords, CountsTheHandsOfEachReason) {
  ContactShares shaft_free{1, 1, 0.04, 1, 1}, lost{0.3, 0.3, 0.3, 0.3, 0.3, 2};
  const ContactShares more_free{1, 1, 0.08, 1, 1};
  EXPECT_EQ(
      contact_words(std::vector<ContactShares>{shaft_free, lost, more_free}, 8),
      "lost contact after 2.0 s in 1 of 8 hands; the shaft touched for 6 % of the time in 2 of 8 hands");
  EXPECT_EQ(contact_words(std::vector<ContactShares>{}, 8), "");
}

TEST(RunMetrics, DoesNotCountCuttingTorqueAsShaftContact) {
  Recording cutting = simple_recording(4000);
  for (TickRecord& record : cutting.records) record.cutting_torque_W_Nmm = record.wrench.torque_Nmm;
  const RunMetrics m = run_metrics(cutting);
  EXPECT_EQ(m.contact.shaft, 0);
  EXPECT_EQ(m.contact.torque, 1);
  EXPECT_FALSE(std::isnan(m.torque_Nmm.mean));
  EXPECT_TRUE(std::isnan(m.shaft.spread_deg));
}

TEST(RunMetrics, GivesNanAndEmptyFieldsWithoutContact) {
  Recording air = simple_recording(4000);
  for (TickRecord& record : air.records) record.wrench = {};
  const RunMetrics m = run_metrics(air);
  EXPECT_EQ(contact_words(m.contact), "never touched");
  EXPECT_TRUE(std::isnan(m.force_N.hp_rms) && std::isnan(m.torque_Nmm.mean) &&
              std::isnan(m.shaft.spread_deg));
  EXPECT_NE(summary_fields({{}, "holding", m}).find(",,,,,,,,,,"), std::string::npos);
}

void expect_refused(const Recording& recording, const std::string& reason) {
  try {
    run_metrics(recording);
    ADD_FAILURE() << reason;
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("some/run.h5: ")) << error.what();
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

TEST(RunMetrics, ReportsWhyARecordingCannotBeMeasured) {
  expect_refused(simple_recording(1), "fewer than two ticks");
  Recording still = simple_recording(10);
  still.records[4].time_s = still.records[3].time_s;
  expect_refused(still, "the time of tick 4");
  Recording broken = simple_recording(10);
  broken.records[7].wrench.torque_Nmm.y() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(broken, "tick 7 is not finite");
  Recording slow = simple_recording(10);
  slow.description.tick_period_s = 0.02;
  expect_refused(slow, "resolve 20 Hz");
}

TEST(RunMetrics, MeasuresForceDespiteATickWithoutADevicePose) {
  Recording gaps = simple_recording(10);
  gaps.records[7].X_WD.position_mm.y() = std::numeric_limits<double>::quiet_NaN();
  gaps.records[7].fault = WrenchFault::pose_not_finite;
  EXPECT_EQ(run_metrics(gaps).force_N.mean, run_metrics(simple_recording(10)).force_N.mean);
}

}  // namespace
}  // namespace osteomill
