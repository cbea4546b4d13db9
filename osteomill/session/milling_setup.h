#pragma once

#include <memory>
#include <optional>

#include "osteomill/geometry/wrench.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/milling/burr_mill.h"
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
  /// Damping where the hand has been given more energy than it gave (WrenchGuard).
  bool passivity_controller = false;
  /// The hand feels the burr cut.
  bool vibration = false;
  /// The hand feels how cutting holds the burr back along its speed (CuttingReaction).
  bool cutting_reaction = false;
};

/// Throws std::invalid_argument, with one line that says why, where a tool cannot work in a scan with this
/// grid: its burr or shaft is wider than the whole scan, its shaft longer than a metre, or its burr so many
/// voxels wide that no algorithm follows it at the haptic rate, or so few that the scan has nothing for it to
/// feel. At once, before anything is prepared.
void require_workable(const MillingTool& tool, const GridGeometry& scan);

MillingSettings milling_settings(const MillingSetup& setup);

/// A session ready to tick; takes as long as the algorithm's preparation. Throws std::invalid_argument where
/// a setting is out of range or the tool cannot work (`require_workable`).
std::unique_ptr<MillingSession> make_session(std::shared_ptr<Volume> bone, const BoneDensities& densities,
                                             const MillingSetup& setup);

}  // namespace osteomill
