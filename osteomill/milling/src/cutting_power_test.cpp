#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/milling/burr_mill.h"

namespace osteomill {
namespace {

TEST(CuttingPower, RemovalRateMatchesHandCalculation) {
  // 60 turns a second of a 2 mm circle: 120 mm/s at the rim; a tenth of the force, 6 N mm for a mm^3.
  EXPECT_NEAR(removal_rate_mm3_per_Ns({3600, 0.1, 6}, 1 / 3.14159265358979), 2.0, 1e-12);
}

TEST(CuttingPower, DefaultRemovalRateIsAbout3Point4Mm3PerNewtonSecond) {
  EXPECT_NEAR(removal_rate_mm3_per_Ns({}, 1.5), 3.427, 0.001);
}

TEST(CuttingPower, RemovalRateScalesWithSpeedRadiusAndInverseEnergy) {
  const double usual = removal_rate_mm3_per_Ns({}, 1.5);
  EXPECT_DOUBLE_EQ(removal_rate_mm3_per_Ns({.spindle_speed_rpm = 80000}, 1.5), 2 * usual);
  EXPECT_DOUBLE_EQ(removal_rate_mm3_per_Ns({}, 3.0), 2 * usual);
  EXPECT_DOUBLE_EQ(removal_rate_mm3_per_Ns({.specific_energy_Nmm_per_mm3 = 1100}, 1.5), usual / 2);
}

TEST(CuttingPower, RefusesNonPositiveSpeedOrRadius) {
  EXPECT_THROW(removal_rate_mm3_per_Ns({.spindle_speed_rpm = 0}, 1.5), std::invalid_argument);
  EXPECT_THROW(removal_rate_mm3_per_Ns({}, -1), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
