#include <cmath>

#include <gtest/gtest.h>

#include "osteomill/study/paper.h"
#include "osteomill/study/trial_plan.h"

namespace osteomill {
namespace {

// 3 s of holding, of which 2 s were planned: in the first second the hand still leans in, with twice the
// force.
Recording late_holding() {
  Recording recording;
  recording.path = "some/holding.h5";
  recording.description.tick_period_s = 1e-3;
  recording.description.phase = kHolding;
  recording.description.settings.push_back({std::string(kScriptHoldingKey), 2.0, "s"});
  for (int n = 0; n < 3000; ++n) {
    TickRecord record;
    record.time_s = 1e-3 * n;
    record.wrench.force_N = {n < 1000 ? 2.0 : 1.0, 0, 0};
    record.wrench.torque_Nmm = {0, 5, 0};
    recording.records.push_back(record);
  }
  return recording;
}

TEST(PhaseMetrics, MeasuresOnlyThePlannedDurationOfAHolding) {
  const Recording holding = late_holding();
  EXPECT_EQ(phase_metrics(holding).steps, 2000u);
  EXPECT_DOUBLE_EQ(phase_metrics(holding).force_N.max, 1);
  EXPECT_DOUBLE_EQ(phase_metrics(holding).counted_from_s, 1);
  Recording milling = holding;
  milling.description.phase = kMilling;
  EXPECT_EQ(phase_metrics(milling).steps, 3000u);
  EXPECT_EQ(phase_metrics(milling).counted_from_s, 0);
  Recording unknown = holding;
  unknown.description.settings.clear();
  EXPECT_EQ(phase_metrics(unknown).steps, 3000u);
}

// In contact and in one place, leaning on the wall, for 2 s.
Recording steady_holding() {
  Recording recording = late_holding();
  recording.records.erase(recording.records.begin(), recording.records.begin() + 1000);
  return recording;
}

TEST(PhaseMetrics, ReportsWhyAHoldingWasNotReached) {
  EXPECT_EQ(measured_phase(steady_holding()).not_reached, "");
  Recording away = steady_holding();
  for (std::size_t n = 0; n < 1200; ++n) away.records[n + 100].wrench = {};
  EXPECT_EQ(measured_phase(away).not_reached,
            "the tool touched for less than 90 % of the holding; "
            "the shaft was against the wall for less than 50 % of the holding");
  Recording leaps = steady_holding();
  for (std::size_t n = 1000; n < 1200; ++n)
    leaps.records[n].X_WT.orientation = quaternion_from_rotation_vector({0.2, 0, 0});
  EXPECT_EQ(measured_phase(leaps).not_reached, "the shaft turned by more than 3 degrees");
  Recording wanders = steady_holding();
  for (std::size_t n = 0; n < wanders.records.size(); ++n)
    wanders.records[n].X_WT.position_mm.x() = 0.003 * static_cast<double>(n);
  EXPECT_EQ(measured_phase(wanders).not_reached, "the burr moved by more than 0.5 mm");
  Recording buzzes = steady_holding();
  for (std::size_t n = 0; n < buzzes.records.size(); ++n)
    buzzes.records[n].X_WT.position_mm.x() = n % 20 < 10 ? -0.4 : 0.4;
  EXPECT_EQ(measured_phase(buzzes).not_reached, "") << "how calm it is held is what is measured";
  // The hand's own shortfall comes first, and milling is not a hold.
  wanders.description.settings.push_back({std::string(kNotReachedKey), std::string("the tool was lost"), ""});
  EXPECT_EQ(measured_phase(wanders).not_reached, "the tool was lost; the burr moved by more than 0.5 mm");
  wanders.description.phase = kMilling;
  EXPECT_EQ(measured_phase(wanders).not_reached, "the tool was lost");
}

TEST(PhaseMetrics, GivesNanIfContactWasLost) {
  Recording lost = late_holding();
  for (std::size_t n = 1900; n < lost.records.size(); ++n) lost.records[n].wrench = {};
  const RunMetrics m = phase_metrics(lost);
  EXPECT_EQ(contact_words(m.contact), "lost contact after 0.9 s");
  EXPECT_TRUE(std::isnan(m.force_N.mean) && std::isnan(m.torque_Nmm.hp_rms) &&
              std::isnan(m.shaft.spread_deg));
}

}  // namespace
}  // namespace osteomill
