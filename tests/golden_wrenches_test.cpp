#include <bit>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/bone_densities.h"

#include "tests/poses.h"
#include "tests/shapes.h"

// Equal input must give bit-identical wrenches at any optimisation level: every preset (-O0, -O1, -O2, with
// and without sanitizers) runs this test against the same hashes. After an intended change of an algorithm,
// replace its hash by the one that the failure prints.
namespace osteomill {
namespace {

struct Golden {
  std::string_view algorithm;
  std::uint64_t hash;
};

// Extends an FNV-1a hash by the bits of a wrench.
std::uint64_t hashed(std::uint64_t hash, const Wrench& wrench) {
  for (const Vec3& vector : {wrench.force_N, wrench.torque_Nmm}) {
    for (const double number : vector) {
      const auto bits = std::bit_cast<std::uint64_t>(number);
      for (int byte = 0; byte < 8; ++byte) hash = (hash ^ ((bits >> (8 * byte)) & 0xff)) * 0x100000001b3;
    }
  }
  return hash;
}

class GoldenWrenches : public ::testing::TestWithParam<Golden> {};

TEST_P(GoldenWrenches, AreBitIdenticalAtAnyOptimisationLevel) {
  constexpr double kBallRadius_mm = 6;
  constexpr int kTicks = 1500;
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(64, 0.25),
                                                testing_support::ball(Vec3::Zero(), kBallRadius_mm));
  const MillingTool tool;
  const BoneDensities densities = estimate_densities(volume);
  MillingSession session(
      std::make_shared<Volume>(std::move(volume)), densities,
      {.algorithm = algorithm_named(GetParam().algorithm), .guard = GuardSettings::for_simulation()});
  PosedDevice device;
  std::uint64_t hash = 0xcbf29ce484222325;
  for (int n = 0; n < kTicks; ++n) {
    device.put(testing_support::down_and_lean(kBallRadius_mm, tool.burr_radius_mm, 2.0,
                                              static_cast<double>(n) / kTicks));
    hash = hashed(hash, session.tick(device, {.time_s = n * 1e-3, .spindle_on = true}).wrench);
  }
  EXPECT_EQ(hash, GetParam().hash) << std::hex << "0x" << hash;
}

INSTANTIATE_TEST_SUITE_P(AllAlgorithms, GoldenWrenches,
                         ::testing::Values(Golden{"line-proxy", 0x77daa7530d79b3b2},
                                           Golden{"surface-points", 0xe2ea466e2b30f36e},
                                           Golden{"point-shell", 0x3467afb63e917654},
                                           Golden{"barrier-shell", 0x549cee164ea16ce5}),
                         [](const auto& test) {
                           std::string name(test.param.algorithm);
                           name[name.find('-')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace osteomill
