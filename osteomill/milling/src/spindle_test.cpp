#include "osteomill/milling/spindle.h"

#include <cmath>
#include <string_view>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

double settled_rpm(Spindle spindle, double torque_Nmm, double seconds = 3) {
  for (int n = 0; n < static_cast<int>(seconds * 1000); ++n) spindle.step(true, torque_Nmm, 1e-3);
  return spindle.speed_rpm();
}

TEST(Spindle, KeepsSetSpeedUnderAnyLoadWithoutAHandpiece) {
  Spindle spindle(Handpiece::none, 30000);
  spindle.step(true, 1e6, 1e-3);
  EXPECT_EQ(spindle.speed_rpm(), 30000);
  spindle.step(false, 0, 1e-3);
  EXPECT_EQ(spindle.speed_rpm(), 0);
}

TEST(Spindle, SettlesOnTheTorqueSpeedLineUnderLoad) {
  for (const Handpiece handpiece : {Handpiece::turbine, Handpiece::electric, Handpiece::surgical}) {
    const HandpieceType& type = handpiece_types()[static_cast<std::size_t>(handpiece)];
    for (const double load : {0.0, 0.25, 0.5, 0.9}) {
      const Spindle spindle(handpiece, type.speed_rpm.value);
      EXPECT_NEAR(settled_rpm(spindle, load * type.stall_Nmm.value), (1 - load) * type.speed_rpm.value,
                  0.02 * type.speed_rpm.value)
          << type.name << " " << load;
    }
  }
}

TEST(Spindle, NineNewtonsHalveASurgicalDrillAndStallATurbine) {
  const double torque_Nmm = 0.4 * 9 * 1.5 * 0.75;
  EXPECT_NEAR(settled_rpm(Spindle(Handpiece::surgical, 40000), torque_Nmm) / 40000, 0.5, 0.02);
  EXPECT_EQ(settled_rpm(Spindle(Handpiece::turbine, 400000), torque_Nmm), 0);
}

// Maximum power measured on 41 turbines; the table was not derived from it.
TEST(Spindle, MaximumTurbinePowerMatchesMeasurement) {
  double max_W = 0;
  for (double torque_Nmm = 0.05; torque_Nmm < 2.3; torque_Nmm += 0.05) {
    const double rpm = settled_rpm(Spindle(Handpiece::turbine, 500000), torque_Nmm);
    max_W = std::max(max_W, torque_Nmm * 2 * 3.14159265 * rpm / 60 * 1e-3);
  }
  EXPECT_NEAR(max_W / 29.6, 1, 0.05);
}

TEST(Spindle, ChangesSpeedWithoutJumpsAndRecoversFromAStall) {
  Spindle spindle(Handpiece::surgical, 40000);
  double before = 0;
  const auto step = [&](bool is_on, double torque_Nmm) {
    spindle.step(is_on, torque_Nmm, 1e-3);
    EXPECT_LT(std::abs(spindle.speed_rpm() - before), 0.02 * 40000);
    before = spindle.speed_rpm();
  };
  for (int n = 0; n < 1000; ++n) step(true, 0);
  EXPECT_GT(before, 0.99 * 40000);
  for (int n = 0; n < 1000; ++n) step(true, 9);
  EXPECT_EQ(before, 0);
  for (int n = 0; n < 1000; ++n) step(true, 1);
  EXPECT_NEAR(before, 40000 * (1 - 1 / 8.1), 0.02 * 40000);
  for (int n = 0; n < 2000; ++n) step(false, 0);
  EXPECT_EQ(before, 0);
}

TEST(Spindle, SpeedIsIndependentOfTickLength) {
  Spindle coarse(Handpiece::electric, 200000), fine(Handpiece::electric, 200000);
  for (int n = 0; n < 100; ++n) coarse.step(true, 3, 1e-3);
  for (int n = 0; n < 400; ++n) fine.step(true, 3, 0.25e-3);
  EXPECT_NEAR(coarse.speed_rpm() / fine.speed_rpm(), 1, 0.01);
}

}  // namespace
}  // namespace osteomill
