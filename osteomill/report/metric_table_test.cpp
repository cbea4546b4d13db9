#include "osteomill/report/metric_table.h"

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"

namespace osteomill {
namespace {

TEST(SummaryCsv, HasItsColumnsInOrder) {
  RunMetrics m;
  m.steps = 1;
  m.step_us = {2, 3, 4};
  m.rate_hz = 5;
  m.force_N = {6, 7, 8, 9};
  m.torque_Nmm = {10, 11, 12, 13};
  m.shaft = {14, 15.5};
  m.removed_mm3 = 16;
  m.contact.any = 0.75;
  m.contact.burr = 0.5;
  m.contact.shaft = 0.25;
  m.contact.lost_after_s = 21;
  m.turns = {17, 18};
  m.torque_follows_force = 0.19;
  m.contacts_mean = 20;
  m.tick_us = {22, 23, 24};
  EXPECT_EQ(
      summary_columns(),
      "algorithm,phase,steps,step_us_median,step_us_p99,step_us_max,rate_hz,force_mean_N,force_max_N,"
      "force_hp_rms_N,force_step_max_N,torque_mean_Nmm,torque_max_Nmm,torque_hp_rms_Nmm,torque_step_max_Nmm,"
      "shaft_spread_deg,shaft_excursion_deg,removed_mm3,contact_share,burr_contact_share,shaft_contact_share,"
      "tick_us_median,tick_us_p99,tick_us_max,"
      "turn_50ms_max_deg,turn_at_torque_step_deg,torque_follows_force,contacts_mean,lost_after_s,not_"
      "reached");
  EXPECT_EQ(summary_fields({algorithm_named("point-shell").id, "holding", m, nullptr, "this; that"}),
            "point-shell,holding,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15.5,16,0.75,0.5,0.25,22,23,24,17,18,0.19,"
            "20,21,this; that");
}

}  // namespace
}  // namespace osteomill
