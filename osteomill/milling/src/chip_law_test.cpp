#include "osteomill/milling/chip_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include <gtest/gtest.h>

#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/cutting_reaction.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

constexpr double kBurr_mm = 1.5;

const ChipContact kContact{2, kBurr_mm, 40000, 3, 1};

double rate(const ChipLaw& law, const ChipContact& contact) {
  return cut_chips(law, contact).rate_mm3_s;
}

TEST(ChipLaw, PowerMatchesEnergyAtTheResultingChipThickness) {
  const ChipLaw law = chip_law(BurrEdge::cutting);
  for (const double force_N : {0.1, 1.0, 10.0}) {
    ChipContact contact = kContact;
    contact.force_N = force_N;
    const ChipCut cut = cut_chips(law, contact);
    const double turns_per_s = 40000.0 / 60;
    EXPECT_NEAR(cut.power_mW, 0.4 * force_N * 2 * std::numbers::pi * turns_per_s * kBurr_mm, 1e-9);
    EXPECT_NEAR(cut.chip_mm, cut.rate_mm3_s / turns_per_s / 3, 1e-12);
    EXPECT_NEAR(cut.power_mW / cut.rate_mm3_s, 1300 * std::pow(cut.chip_mm / 0.048, -0.3),
                1e-6 * cut.power_mW);
  }
}

TEST(ChipLaw, RateIsPowerOverEnergyForZeroExponent) {
  const ChipEdge edge{500, 0.048, 0};
  const ChipCut cut = cut_chips({edge, edge, 1, 0.3, 1}, kContact);
  EXPECT_DOUBLE_EQ(cut.rate_mm3_s, cut.power_mW / 500);
}

TEST(ChipLaw, RateGrowsMoreThanLinearlyWithForce) {
  const ChipLaw law = chip_law(BurrEdge::cutting);
  ChipContact firm = kContact;
  firm.force_N *= 2;
  EXPECT_NEAR(rate(law, firm) / rate(law, kContact), std::pow(2.0, 1 / 0.7), 1e-9);
}

TEST(ChipLaw, DiamondBurrNeverCutsFasterThanCuttingBurr) {
  for (double force_N = 0.25; force_N < 30; force_N *= 2) {
    ChipContact contact = kContact;
    contact.force_N = force_N;
    EXPECT_LE(rate(chip_law(BurrEdge::diamond), contact), rate(chip_law(BurrEdge::cutting), contact));
  }
  EXPECT_LT(rate(chip_law(BurrEdge::diamond), kContact), 0.5 * rate(chip_law(BurrEdge::cutting), kContact));
}

TEST(ChipLaw, TwentyCutsOfWearReduceTheRateByAFifth) {
  for (const BurrEdge burr : {BurrEdge::cutting, BurrEdge::diamond}) {
    EXPECT_NEAR(rate(chip_law(burr, 20), kContact), 0.8 * rate(chip_law(burr), kContact), 1e-12);
  }
}

TEST(ChipLaw, EnergyMatchesTheTableAndRisesWithDensity) {
  double before = 0;
  for (double density = 0.02; density < 4; density *= 1.05) {
    EXPECT_GT(chip_energy_Nmm_per_mm3(density), before) << density;
    before = chip_energy_Nmm_per_mm3(density);
  }
  for (const Material& material : materials()) {
    EXPECT_NEAR(chip_energy_Nmm_per_mm3(material.density.value) / material.energy_Nmm_per_mm3.value, 1, 1e-9)
        << material.name;
  }
}

TEST(ChipLaw, EveryTableValueNamesItsSource) {
  const auto has_source = [](const Sourced& cell) {
    const std::string_view source = cell.source;
    return source.starts_with("assumed") || source.find("19") != source.npos ||
           source.find("20") != source.npos || source.find("abstract") != source.npos;
  };
  for (const Material& m : materials())
    EXPECT_TRUE(has_source(m.density) && has_source(m.energy_Nmm_per_mm3)) << m.name;
  for (const BurrType& b : burr_types())
    EXPECT_TRUE(has_source(b.exponent) && has_source(b.chip_mm) && has_source(b.edges) &&
                has_source(b.friction))
        << b.name;
}

TEST(ChipLaw, RateIsZeroWithoutForceSpeedOrContactArea) {
  const ChipLaw law = chip_law(BurrEdge::cutting);
  EXPECT_EQ(rate(law, {0, kBurr_mm, 40000, 3, 1}), 0);
  EXPECT_EQ(rate(law, {2, kBurr_mm, 0, 3, 1}), 0);
  EXPECT_EQ(rate(law, {2, kBurr_mm, 40000, 0, 1}), 0);
  EXPECT_EQ(rate(law, {std::nan(""), kBurr_mm, 40000, 3, 1}), 0);
}

struct Plunge {
  double speed_mm_s = 0;
  double removed_mm3 = 0;
  double paid_mm3 = 0;
  CutBone bone;
};

constexpr double kArea_mm2 = std::numbers::pi * kBurr_mm * kBurr_mm;

// Presses a burr down in a bowl of its own shape, in bone of `density` relative to the reference, and
// advances it by the depth removed.
Plunge plunge(double force_N, double spacing_mm, double density) {
  const auto bowl = [](const Vec3& point_W) { return std::max(point_W.z(), kBurr_mm - point_W.norm()); };
  Volume bone = testing_support::shape_volume(
      testing_support::centred_cube(static_cast<int>(7 / spacing_mm), spacing_mm), bowl);
  MillingSettings settings;
  settings.chips = chip_law(BurrEdge::cutting);
  BurrMill mill(bone, kBurr_mm, {0, 1000 / density}, settings);
  constexpr double kTick_s = 1e-3;
  constexpr int kTicks = 1500;
  Plunge all;
  Vec3 burr_W = Vec3::Zero();
  double half_way_z = 0;
  for (int n = 0; n < kTicks; ++n) {
    const MillingStep step = mill.step(burr_W, Vec3(0, 0, -force_N), kTick_s);
    all.removed_mm3 += step.removed_mm3;
    all.paid_mm3 += step.rate_mm3_s * kTick_s;
    burr_W.z() -= step.removed_mm3 / (kArea_mm2 * density);
    if (n == kTicks / 2) half_way_z = burr_W.z();
  }
  all.speed_mm_s = (half_way_z - burr_W.z()) / (kTicks / 2 * kTick_s);
  all.bone = mill.cut_bone();
  return all;
}

TEST(ChipMill, PlungeSpeedMatchesTheClosedForm) {
  const ChipLaw law = chip_law(BurrEdge::cutting);
  for (const double density : {0.7, 1.0, 1.4}) {
    const Plunge cut = plunge(5, 0.125, density);
    const double expected_mm_s = rate(law, {5, kBurr_mm, 40000, kArea_mm2, density}) / kArea_mm2;
    EXPECT_NEAR(cut.speed_mm_s / expected_mm_s, 1, 0.02) << density;
    EXPECT_NEAR(cut.removed_mm3 / cut.paid_mm3, 1, 0.01) << density;
    EXPECT_NEAR(cut.bone.density / density, 1, 0.02);
    EXPECT_NEAR(cut.bone.area_mm2 / kArea_mm2, 1, 0.02) << density;
  }
}

TEST(ChipMill, PlungeSpeedIsIndependentOfVoxelSize) {
  const double usual = plunge(6, 0.125, 1).speed_mm_s;
  EXPECT_NEAR(plunge(6, 0.2, 1).speed_mm_s / usual, 1, 0.02);
  EXPECT_NEAR(plunge(6, 0.08, 1).speed_mm_s / usual, 1, 0.02);
}

TEST(ChipMill, PayingForceIsLessAtThePoleThanAtTheEquator) {
  MillingSettings settings;
  settings.chips = chip_law(BurrEdge::cutting);
  EXPECT_NEAR(paying_force_W_N(settings, {}, {2, 0, 0}, true).norm(), 1.5, 1e-12);
  EXPECT_NEAR(paying_force_W_N(settings, {}, {0, 0, -2}, true).norm(), 1.0, 1e-12);
}

}  // namespace
}  // namespace osteomill
