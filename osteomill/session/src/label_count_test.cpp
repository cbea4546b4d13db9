#include <gtest/gtest.h>

#include "osteomill/session/tick_counts.h"

namespace osteomill {
namespace {

TickRecord tick(double time_s, double force_N, const LabelCuts& cuts) {
  TickRecord record;
  record.time_s = time_s;
  record.dt_s = 1e-3;
  record.burr_force_W_N = {0, 0, -force_N};
  record.label_cuts = cuts;
  return record;
}

TEST(LabelCount, CountsVolumeTimeForceAndContactsOfEachLabel) {
  LabelCount count({{3, "bone", {}}, {8, "nerve", {}, true}});
  EXPECT_EQ(count.add(tick(0, 9, {})), std::nullopt);
  EXPECT_EQ(count.add(tick(1.000, 1, {LabelCut{1, 0.5}})), std::nullopt);
  EXPECT_EQ(count.add(tick(1.001, 3, {LabelCut{1, 0.25}, LabelCut{2, 0}})),
            "no-go: the burr touched nerve at 1.001 s, pressing with 3.00 N");
  // The first tick continues the contact, the second, over half a second later, begins another.
  EXPECT_EQ(count.add(tick(1.4, 2, {LabelCut{2, 0.125}})), std::nullopt);
  EXPECT_NE(count.add(tick(1.95, 2, {LabelCut{2, 0.125}})), std::nullopt);
  const LabelCount::Entry& bone = count.entries()[0];
  EXPECT_DOUBLE_EQ(bone.removed_mm3, 0.75);
  EXPECT_DOUBLE_EQ(bone.first_s, 1.0);
  EXPECT_DOUBLE_EQ(bone.last_s, 1.001);
  EXPECT_DOUBLE_EQ(bone.time_s, 0.002);
  EXPECT_DOUBLE_EQ(bone.force_mean_N, 2);
  EXPECT_DOUBLE_EQ(bone.force_max_N, 3);
  EXPECT_EQ(bone.contacts, 1);
  const LabelCount::Entry& nerve = count.entries()[1];
  EXPECT_DOUBLE_EQ(nerve.removed_mm3, 0.25);
  EXPECT_EQ(nerve.contacts, 2);
  EXPECT_EQ(count.last_no_go_s(), 1.95);
  EXPECT_EQ(label_lines(count).size(), 2u);
}

}  // namespace
}  // namespace osteomill
