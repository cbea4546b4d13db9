#include "osteomill/study/metric_table.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"

namespace osteomill {
namespace {

TEST(SummaryCsv, WritesColumnsAndFieldsInTheSameOrder) {
  RunMetrics m;
  m.steps = 1;
  m.step_us = {2, 3, 4};
  m.rate_hz = 5;
  m.force_N = {6, 7, 8, 9, 0.125};
  m.torque_Nmm = {10, 11, 12, 13, 0.25};
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
  m.contact.lost_while_milling = true;
  m.contact.force = 0.625;
  m.contact.torque = 0.375;
  m.path_mm = 25;
  m.burr_excursion_mm = 30;
  m.put_back_mm3 = 26;
  m.counted_from_s = 27;
  m.shaft_from_handle_deg = 28;
  m.removal_mm3_per_s = 29;
  EXPECT_EQ(
      summary_columns(),
      "algorithm,phase,steps,step_us_median,step_us_p99,step_us_max,rate_hz,force_mean_N,force_max_N,"
      "force_hp_rms_N,force_step_max_N,torque_mean_Nmm,torque_max_Nmm,torque_hp_rms_Nmm,torque_step_max_Nmm,"
      "shaft_spread_deg,shaft_excursion_deg,removed_mm3,contact_share,burr_contact_share,shaft_contact_share,"
      "tick_us_median,tick_us_p99,tick_us_max,"
      "turn_50ms_max_deg,turn_at_torque_step_deg,torque_follows_force,contacts_mean,lost_after_s,"
      "lost_while_milling,force_contact_share,torque_contact_share,force_hp_share,torque_hp_share,path_mm,"
      "burr_excursion_mm,put_back_mm3,shaft_from_handle_deg,removal_mm3_per_s,counted_from_s,not_reached");
  EXPECT_EQ(summary_fields({algorithm_named("point-shell").id, "holding", m, nullptr, "this; that"}),
            "point-shell,holding,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15.5,16,0.75,0.5,0.25,22,23,24,17,18,0.19,"
            "20,21,1,0.625,0.375,0.125,0.25,25,30,26,28,29,27,this; that");
}

// A figure without a field would be lost between a trial and its study.
TEST(RunMetrics, EveryMemberIsADistinctField) {
  RunMetrics m;
  double next = 0;
  for (const Field<RunMetrics>& figure : fields_of<RunMetrics>())
    figure.set(m, figure.name == "lost_while_milling" ? 1 : ++next);
  EXPECT_EQ(sizeof(RunMetrics) / sizeof(double), fields_of<RunMetrics>().size());
  next = 0;
  for (const Field<RunMetrics>& figure : fields_of<RunMetrics>())
    EXPECT_EQ(figure.get(m), figure.name == "lost_while_milling" ? 1 : ++next) << figure.name;
  EXPECT_THROW(metric("force"), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
