#pragma once

#include <memory>
#include <optional>

#include "osteomill/geometry/wrench.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/cutting_power.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/tool/milling_tool.h"

namespace osteomill {

/// Everything that can be chosen for milling a bone, beside the bone.
struct MillingSetup {
  MillingTool tool;
  AlgorithmDescription algorithm = default_algorithm();
  HapticSettings haptics;
  CuttingSettings cutting;
  /// Not given: follows from `cutting` and the burr.
  std::optional<double> removal_rate_mm3_per_Ns;
  WrenchLimits limits;
  /// The hand feels the burr cut.
  bool vibration = false;
};

MillingSettings milling_settings(const MillingSetup& setup);

/// A session ready to tick; takes as long as the algorithm's preparation. Throws std::invalid_argument where
/// a setting is out of range.
std::unique_ptr<MillingSession> make_session(std::shared_ptr<Volume> bone, const BoneDensities& densities,
                                             const MillingSetup& setup);

}  // namespace osteomill
