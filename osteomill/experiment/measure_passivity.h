#pragma once

#include <vector>

#include "osteomill/experiment/stiffness_limit.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// One algorithm on one device.
struct PassivityCase {
  AlgorithmDescription algorithm;
  Mode mode = Mode::steady;
  double damping_Ns_per_mm = 0;
  double delay_s = 0;
};

/// How stiff it can be there.
struct PassivityRow {
  PassivityCase setup;
  /// By the algorithm's own setting (--stiffness), which need not be what is felt.
  StiffnessLimit limit;
  /// What an ideal wall could be.
  double rule_N_per_mm = 0;
};

/// Every algorithm that has a setting of the option "stiffness", in every mode that it has, on devices with
/// 1, 2, 5 and 10 N s/m of damping and 0.3, 1 and 2 ms of delay.
std::vector<PassivityCase> passivity_cases(const std::vector<AlgorithmDescription>& algorithms,
                                           const std::vector<Mode>& modes);

/// Bone that fills z < 0, wide and deep enough to press this tool on, of voxels a twelfth of the burr's
/// radius (0.05 to 0.5 mm).
Volume flat_wall(const MillingTool& tool);

/// Seeks the greatest `--stiffness` at which the wall stays passive (wall_press.h). Of `haptics` everything
/// counts but the mode and that stiffness, of `handle` all but the delay. Throws std::invalid_argument where
/// a setting is out of range.
PassivityRow measure_passivity(const PassivityCase& setup, const Volume& wall, const MillingTool& tool,
                               const HapticSettings& haptics, const HandleSettings& handle, double tick_s);

}  // namespace osteomill
