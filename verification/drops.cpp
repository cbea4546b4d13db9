#include <algorithm>

#include <fmt/core.h>

#include "osteomill/session/simulated_handle.h"

#include "verification/probing.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr double kDamping_Ns_per_mm = 0.0055;
constexpr double kWeight_N = 2.94;  // of the handle's 0.3 kg
constexpr double kMax_s = 1;
constexpr int kSlopes = 6;

// Advances the handle by one tick, under its weight along -`normal` and the device's own damping.
void fall(SimulatedHandle& handle, const Vec3& normal) {
  const int substeps = static_cast<int>(kTick_s / handle.settings().substep_s + 0.5);
  for (int n = 0; n < substeps; ++n) {
    handle.advance({-kWeight_N * normal - kDamping_Ns_per_mm * handle.velocity().linear_mm_s, Vec3::Zero()});
  }
}

// Returns the ratio of a dropped handle's kinetic energy after the rebound from a plane of random slope to
// that before; 0 if it stays.
double rebound(std::string_view algorithm, double stiffness, double height_mm, SeededRandom& random) {
  using namespace testing_support;
  const Vec3 normal = random_direction(random);
  const Volume volume = shape_volume(centred_cube(60, 0.2), plane(Vec3::Zero(), normal));
  const MillingTool tool;
  const auto haptics = prepared(algorithm, volume, tool, stiffness);
  const bool centreline = algorithm == "line-proxy";
  const double resting_mm = centreline ? 0 : tool.burr_radius_mm;
  SimulatedHandle handle(HandleSettings{},
                         {(resting_mm + height_mm) * normal, smallest_rotation(Vec3::UnitZ(), normal)});
  double impact_Nmm = 0;
  double before_Nmm = 0;
  for (int n = 0; n < static_cast<int>(kMax_s / kTick_s); ++n) {
    const HapticStep step = haptics->step(handle.read(), kTick_s);
    handle.command(step.wrench);
    const bool touches = step.contacts > 0;
    if (touches && impact_Nmm == 0) impact_Nmm = before_Nmm;
    if (!touches && impact_Nmm > 0) return handle.kinetic_energy_Nmm() / impact_Nmm;
    before_Nmm = handle.kinetic_energy_Nmm();
    fall(handle, normal);
  }
  return 0;
}

}  // namespace

Section drops() {
  Section section{
      "Dropped on bone",
      fmt::format(
          "Must hold for 4: the handle rebounds with less energy than it had before. The handle of 0.3 "
          "kg falls under its weight from 1, 5 and 20 mm onto {} planes of random slope, with 5.5 N s/m "
          "of damping and stiffnesses up to 5 N/mm (2: up to 20); ratio of the kinetic energies, median "
          "(worst).",
          kSlopes),
      {"algorithm, stiffness", "energy left", ""},
      {},
      {}};
  for (const std::string& algorithm : algorithm_names()) {
    for (const double stiffness : {1.0, 2.0, 5.0, 20.0}) {
      if (stiffness > 5 && algorithm != "surface-points") continue;
      SeededRandom random(5);
      std::vector<double> shares;
      for (int n = 0; n < kSlopes; ++n) {
        for (const double height_mm : {1.0, 5.0, 20.0}) {
          shares.push_back(rebound(algorithm, stiffness, height_mm, random));
        }
      }
      section.add_of(algorithm,
                     {fmt::format("{}, {:.0f} N/mm", algorithm, stiffness), median_and_worst(shares)},
                     percentile(shares, 1) < 1);
    }
  }
  return section;
}

}  // namespace osteomill::verification
