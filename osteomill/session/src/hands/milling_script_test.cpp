#include "osteomill/session/milling_script.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/session/simulated_operator.h"

#include "tests/analytic_hole.h"
#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::AnalyticHole;
using testing_support::centred_cube;
using testing_support::shape_volume;

constexpr double kTick_s = 1e-3;
const MillingTool kTool;

MillingEntry on_a_plane() {
  static const Volume volume =
      shape_volume(centred_cube(40, 0.5), testing_support::plane({0, 0, 1}, {0, 0, 1}));
  return place_entry(volume, kTool);
}

MillingEntry on_a_ball() {
  static const Volume volume = shape_volume(centred_cube(40, 0.5), testing_support::ball({0, 0, 0}, 8));
  return place_entry(volume, kTool, Vec3(9, 7, 4), Vec3(-9, -7, -4));
}

struct Sample {
  double time_s;
  ScriptStage stage;
  bool milling;
  Pose X_W_target;
  Pose X_WD;
  Wrench hand;
  double shown_tip_mm;
  double device_mm;
  double lean_rad;
};

OperatorSettings without_tremor() {
  OperatorSettings settings;
  settings.hand.tremor_mm = settings.hand.tremor_rad = 0;
  return settings;
}

std::vector<Sample> run(const OperatorSettings& settings, const MillingEntry& entry, AnalyticHole hole) {
  SimulatedOperator person(settings, kTool, entry);
  std::vector<Sample> samples;
  while (!person.finished()) {
    const Pose X_WD = person.read_pose();
    const auto step = hole.step(X_WD, person.is_spindle_requested(), kTick_s);
    person.write_wrench(step.wrench);
    const auto depth_mm = [&](const Pose& X) { return entry.direction_W.dot(X.position_mm - entry.point_W); };
    samples.push_back({person.time_s(), person.stage(), person.is_spindle_requested(), person.target(), X_WD,
                       person.hand_wrench(), depth_mm(step.X_WT) + kTool.burr_radius_mm, depth_mm(X_WD),
                       std::acos(std::min(1.0, -shaft_direction(X_WD).dot(entry.direction_W)))});
    person.tick_done(step.X_WT, kTick_s);
  }
  return samples;
}

AnalyticHole yielding_hole(const MillingEntry& entry, AnalyticHole::Kind kind = AnalyticHole::Kind::direct) {
  return {entry, kTool.burr_radius_mm, kind, 0.35};
}

std::size_t first_of(const std::vector<Sample>& samples, ScriptStage stage) {
  std::size_t n = 0;
  while (n < samples.size() && samples[n].stage != stage) ++n;
  return n;
}

template <typename Value>
double mean_between(const std::vector<Sample>& samples, double from_s, double to_s, const Value& value) {
  double sum = 0;
  int count = 0;
  for (const Sample& sample : samples) {
    if (sample.time_s < from_s || sample.time_s >= to_s) continue;
    sum += value(sample);
    ++count;
  }
  return sum / count;
}

TEST(MillingScript, StartsThreeMillimetresAboveBoneAndTouchesAfterASecond) {
  for (const MillingEntry& entry : {on_a_plane(), on_a_ball()}) {
    const auto samples = run(without_tremor(), entry, yielding_hole(entry));
    EXPECT_NEAR(samples.front().shown_tip_mm, -3.0, 0.01);
    std::size_t touch = 0;
    while (samples[touch].shown_tip_mm < 0) ++touch;
    EXPECT_NEAR(samples[touch].time_s, 1.0, 0.15);
    EXPECT_EQ(samples[0].stage, ScriptStage::approach);
    EXPECT_TRUE(samples[0].milling);
    for (std::size_t n = 0; n < touch; ++n) EXPECT_LT(samples[n].lean_rad, 1e-3);
  }
}

TEST(MillingScript, FeedsWithNineTenthsOfThePushUntilThreeMillimetresDeep) {
  for (double push_N : {1.5, 3.0}) {
    OperatorSettings settings = without_tremor();
    settings.hand.push_N = push_N;
    const MillingEntry entry = on_a_ball();
    // Bone as much harder as the hand pushes harder, so that the hole grows at the same speed.
    const AnalyticHole hole(entry, kTool.burr_radius_mm, AnalyticHole::Kind::direct, 0.5 / push_N);
    const auto samples = run(settings, entry, hole);
    const std::size_t lean = first_of(samples, ScriptStage::lean);
    ASSERT_LT(lean, samples.size());
    EXPECT_NEAR(samples[lean].shown_tip_mm, 3.0, 0.02);
    const double until_s = samples[lean].time_s;
    const auto push_along = [&](const Sample& s) { return s.hand.force_N.dot(entry.direction_W); };
    // The floor recedes, so the push lags slightly behind nine tenths.
    EXPECT_NEAR(mean_between(samples, until_s - 1, until_s, push_along) / push_N, 0.87, 0.04);
    for (const Sample& s : samples) EXPECT_LT(s.hand.force_N.norm(), push_N + 0.1) << s.time_s;
  }
}

TEST(MillingScript, LeansUntilTheTargetTorqueAndKeepsItWithTheSpindleOn) {
  const MillingEntry entry = on_a_ball();
  const auto samples = run(without_tremor(), entry, yielding_hole(entry));
  const double from_s = samples[first_of(samples, ScriptStage::lean)].time_s;
  EXPECT_LT(from_s, 12.0);
  // Free leaning from rest: 8 degrees per second.
  const auto lean = [](const Sample& s) { return s.lean_rad; };
  EXPECT_NEAR(mean_between(samples, from_s + 1.0, from_s + 1.001, lean), 0.14, 0.01);
  const auto torque = [](const Sample& s) { return s.hand.torque_Nmm.norm(); };
  const auto along = [&](const Sample& s) { return s.hand.force_N.dot(entry.direction_W); };
  EXPECT_NEAR(mean_between(samples, 16, 20, torque), 0.8 * 15, 0.3);
  EXPECT_NEAR(mean_between(samples, 16, 20, along), 0.6 * 1.5, 0.05);
  EXPECT_TRUE(samples[19999].milling);
  EXPECT_EQ(samples[19999].stage, ScriptStage::lean);
  // The shaft leans towards the lateral side.
  EXPECT_GT(shaft_direction(samples[19999].X_WD).dot(entry.lateral_W), 0.19);
}

TEST(MillingScript, HoldsStillWithTheSpindleOffAndTheShaftAgainstTheRim) {
  const MillingEntry entry = on_a_ball();
  const auto samples = run(without_tremor(), entry, yielding_hole(entry));
  ASSERT_EQ(samples.size(), 40000u);
  EXPECT_FALSE(samples[20000].milling);
  EXPECT_EQ(samples[20000].stage, ScriptStage::settle);
  EXPECT_EQ(samples[21000].stage, ScriptStage::hold);
  for (std::size_t n = 21000; n < samples.size(); ++n) {
    ASSERT_FALSE(samples[n].milling);
    ASSERT_EQ(samples[n].X_W_target.position_mm, samples[21000].X_W_target.position_mm);
    ASSERT_EQ(samples[n].X_W_target.orientation.coeffs(), samples[21000].X_W_target.orientation.coeffs());
    ASSERT_LT((samples[n].X_WD.position_mm - samples[39999].X_WD.position_mm).norm(), 0.1) << n;
  }
  const auto torque = [](const Sample& s) { return s.hand.torque_Nmm.norm(); };
  const auto along = [&](const Sample& s) { return s.hand.force_N.dot(entry.direction_W); };
  EXPECT_NEAR(mean_between(samples, 22, 40, torque), 0.8 * 15, 0.3);
  EXPECT_NEAR(mean_between(samples, 22, 40, along), 0.5 * 1.5, 0.05);
}

// The hand leans into a yielding wall no farther than into a firm one, although it does not reach the torque.
TEST(MillingScript, BoundsTheLeanIntoFirmAndYieldingWalls) {
  OperatorSettings settings = without_tremor();
  settings.script.milling_s = 8;
  settings.script.holding_s = 4;
  settings.script.until_leant = true;
  const auto leant_rad = [&](double wall_Nmm_per_rad) {
    constexpr double kWall_rad = 0.1;
    SimulatedOperator person(settings, kTool, {});
    double max_rad = 0;
    while (!person.finished()) {
      const Pose device = person.read_pose();
      const Vec3 turn =
          rotation_vector(device.orientation * pose_above({}, kTool, 0).orientation.conjugate());
      const double beyond_rad = std::max(0.0, turn.norm() - kWall_rad);
      // Bone below; the hole is deep enough from the start.
      person.write_wrench(
          {{0, 0, std::max(0.0, 2 * (kTool.burr_radius_mm - 4 - device.position_mm.z()))},
           beyond_rad > 0 ? Vec3(-wall_Nmm_per_rad * beyond_rad * turn.normalized()) : Vec3(Vec3::Zero())});
      max_rad = std::max(max_rad, turn.norm() - kWall_rad);
      person.tick_done(device, kTick_s);
    }
    return max_rad;
  };
  const double twist_rad = 0.8 * 15 / 500;
  EXPECT_LT(leant_rad(5000), 0.3 * twist_rad);
  EXPECT_LT(leant_rad(50), 1.2 * twist_rad);
}

// The floor disappears under the tool while it leans, as if it left the tooth sideways.
TEST(MillingScript, EndsMillingAndReportsALostToolThatLeavesTheBone) {
  OperatorSettings settings = without_tremor();
  settings.script.milling_s = 8;
  settings.script.holding_s = 4;
  settings.script.until_leant = true;
  SimulatedOperator person(settings, kTool, {});
  double lean_s = 0;
  Vec3 last_touched_W = Vec3::Zero();
  while (!person.finished()) {
    const Pose device = person.read_pose();
    if (person.stage() < ScriptStage::lean) lean_s = person.time_s();
    const bool gone = person.time_s() > lean_s + 1;
    const double floor_N = gone ? 0 : 2 * (kTool.burr_radius_mm - 4 - device.position_mm.z());
    person.write_wrench({{0, 0, std::max(0.0, floor_N)}, Vec3::Zero()});
    if (floor_N > 0) last_touched_W = device.position_mm;
    person.tick_done(device, kTick_s);
  }
  EXPECT_TRUE(person.shortfall().lost);
  EXPECT_FALSE(person.shortfall().hardly_leant || person.shortfall().unsettled)
      << "only the lost tool is reported";
  EXPECT_NEAR(person.time_s(), lean_s + 1 + 1 + 4, 0.1) << "milling ends when the tool is lost";
  // At most 1.01 s at feed speed plus the stretch of the released spring.
  EXPECT_GT(person.read_pose().position_mm.z(), last_touched_W.z() - 2 * 1.01 - 1.5 / 0.5);
}

// The first algorithm touches bone with the device's centre, 1.5 mm deeper than the shown burr, and then
// sinks in by force / stiffness. The script judges the hole by the shown burr.
TEST(MillingScript, MeasuresTheHoleByTheShownToolNotTheDevice) {
  const MillingEntry entry = on_a_plane();
  const auto samples = run(without_tremor(), entry, yielding_hole(entry, AnalyticHole::Kind::line_proxy));
  const std::size_t lean = first_of(samples, ScriptStage::lean);
  ASSERT_LT(samples[lean].time_s, 12.0);
  EXPECT_NEAR(samples[lean].shown_tip_mm, 3.0, 0.02);
  EXPECT_GT(samples[lean].device_mm, 3.0 + 0.5);  // the direct tool's is at 1.5
  const auto along = [&](const Sample& s) { return s.hand.force_N.dot(entry.direction_W); };
  EXPECT_NEAR(mean_between(samples, samples[lean].time_s - 1, samples[lean].time_s, along), 0.87 * 1.5, 0.06);
}

TEST(MillingScript, StartsLeaningAfterSixTenthsOfMillingIfBoneDoesNotYield) {
  const MillingEntry entry = on_a_plane();
  const auto samples =
      run(without_tremor(), entry, {entry, kTool.burr_radius_mm, AnalyticHole::Kind::direct, 0.0});
  EXPECT_NEAR(samples[first_of(samples, ScriptStage::lean)].time_s, 12.0, 0.002);
  for (const Sample& s : samples) {
    ASSERT_LT((s.X_WD.position_mm - entry.point_W).norm(), 6.0);
    ASSERT_LT(s.lean_rad, 0.7);
  }
}

TEST(MillingScript, TargetStaysWithinBoundsInFreeAir) {
  MillingEntry entry;  // no bone at all
  OperatorSettings settings = without_tremor();
  settings.script.milling_s = 4;
  settings.script.holding_s = 2;
  SimulatedOperator person(settings, kTool, entry);
  while (!person.finished()) {
    person.tick_done(person.read_pose(), kTick_s);
    ASSERT_LT((person.target().position_mm - entry.point_W).norm(), 12.0);
  }
  EXPECT_NEAR(person.time_s(), 6.0, 1e-9);
}

// Without feeling the wall the hand mills and settles for the maximum time, otherwise for the minimum.
TEST(MillingScript, MillsAndSettlesLongerIfTheShaftMeetsNoWall) {
  OperatorSettings settings = without_tremor();
  settings.script.milling_s = 8;
  settings.script.holding_s = 4;
  settings.script.until_leant = true;
  const auto milled_and_held_s = [&](double wall_Nmm_per_rad) {
    SimulatedOperator person(settings, kTool, {});
    double milled_s = 0;
    while (!person.finished()) {
      const Pose device = person.read_pose();
      // Bone below, and a wall that resists rotation of the shaft.
      const Vec3 turn =
          rotation_vector(device.orientation * pose_above({}, kTool, 0).orientation.conjugate());
      person.write_wrench({{0, 0, std::max(0.0, 2 * (kTool.burr_radius_mm - 4 - device.position_mm.z()))},
                           -wall_Nmm_per_rad * turn});
      if (person.is_spindle_requested()) milled_s = person.time_s();
      person.tick_done(device, kTick_s);
    }
    return std::pair(milled_s, person.time_s() - milled_s);
  };
  const auto [milled_s, held_s] = milled_and_held_s(300);
  EXPECT_LT(milled_s, 14);
  EXPECT_NEAR(held_s, 4, 0.01);
  const auto [milled_in_air_s, held_in_air_s] = milled_and_held_s(0);
  EXPECT_GT(milled_in_air_s, milled_s + 1);
  EXPECT_LE(milled_in_air_s, 3 * 8);
  EXPECT_NEAR(held_in_air_s, 4 - settings.script.settle_s + 0.5 * 4, 0.01);
}

TEST(MillingScript, RotatingTheSceneRotatesTheIntent) {
  const Pose turn{{5, -3, 2}, quaternion_from_rotation_vector({0.7, 0.2, -0.4})};
  const MillingEntry plain = on_a_ball();
  const MillingEntry other{turn * plain.point_W, turn.orientation * plain.direction_W,
                           turn.orientation * plain.lateral_W};
  MillingScript one({}, {}, kTool, plain);
  MillingScript two({}, {}, kTool, other);
  for (int n = 1; n < 20500; ++n) {
    const Pose& target = one.intent().X_W_target;
    const Pose device{target.position_mm - Vec3(0.3, 0.1, 0.2),
                      quaternion_from_rotation_vector({0.002, 0.003, 0}) * target.orientation};
    const Pose device_turned = turn * device;
    // From step 13000 on the shaft touches a wall.
    const Wrench felt{{0, 0, 1}, n < 13000 ? Vec3::Zero() : Vec3(2, -1, 0.5)};
    const Wrench felt_turned{turn.orientation * felt.force_N, turn.orientation * felt.torque_Nmm};
    one.step(n * kTick_s, kTick_s, device, device, felt);
    two.step(n * kTick_s, kTick_s, device_turned, device_turned, felt_turned);
    const Pose expected = turn * one.intent().X_W_target;
    ASSERT_LT((expected.position_mm - two.intent().X_W_target.position_mm).norm(), 1e-8);
    ASSERT_LT((shaft_direction(expected) - shaft_direction(two.intent().X_W_target)).norm(), 1e-8);
    ASSERT_EQ(one.intent().stage, two.intent().stage);
  }
}

TEST(MillingScript, ASettingOutOfRangeIsRefused) {
  const auto refused = [](auto change) {
    ScriptSettings settings;
    change(settings);
    EXPECT_THROW(MillingScript(settings, {}, kTool, {}), std::invalid_argument);
  };
  refused([](ScriptSettings& s) { s.milling_s = -1; });
  refused([](ScriptSettings& s) { s.settle_s = std::nan(""); });
}

}  // namespace
}  // namespace osteomill
