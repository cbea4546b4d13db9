#include "osteomill/session/milling_setup.h"

#include <utility>

#include "osteomill/haptics/algorithms.h"

namespace osteomill {

MillingSettings milling_settings(const MillingSetup& setup) {
  MillingSettings milling;
  milling.removal_rate_mm3_per_Ns = setup.removal_rate_mm3_per_Ns.value_or(
      removal_rate_mm3_per_Ns(setup.cutting, setup.tool.burr_radius_mm));
  return milling;
}

std::unique_ptr<MillingSession> make_session(std::shared_ptr<Volume> bone, const BoneDensities& densities,
                                             const MillingSetup& setup) {
  auto session = std::make_unique<MillingSession>(std::move(bone), setup.tool,
                                                  make_algorithm(setup.algorithm, setup.haptics), densities,
                                                  milling_settings(setup), setup.limits);
  VibrationSettings vibration;
  vibration.on = setup.vibration;
  vibration.spindle_speed_rpm = setup.cutting.spindle_speed_rpm;
  session->set_vibration(vibration);
  return session;
}

}  // namespace osteomill
