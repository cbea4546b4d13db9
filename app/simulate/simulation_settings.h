#pragma once

#include <optional>

#include "osteomill/geometry/wrench.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/cutting_power.h"
#include "osteomill/tool/milling_tool.h"

namespace osteomill::app {

/// What can be changed while milling goes on.
struct SimulationSettings {
  MillingTool tool;
  AlgorithmDescription algorithm = algorithm_named("point-shell");
  HapticSettings haptics;
  CuttingSettings cutting;
  /// Not given: follows from `cutting` and the burr.
  std::optional<double> removal_rate_mm3_per_Ns;
  WrenchLimits limits;
  /// The hand feels the burr cut.
  bool vibration = true;
};

inline MillingSettings milling_settings(const SimulationSettings& settings) {
  MillingSettings milling;
  milling.removal_rate_mm3_per_Ns = settings.removal_rate_mm3_per_Ns.value_or(
      removal_rate_mm3_per_Ns(settings.cutting, settings.tool.burr_radius_mm));
  return milling;
}

}  // namespace osteomill::app
