#pragma once

#include <string>
#include <vector>

#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/volume/density_block.h"

namespace osteomill {

/// What a session begins from, where that is not a scan that nobody has touched: with the inputs of its ticks
/// all that it takes to run them again.
struct SessionStart {
  RunDescription run;
  TakenOver taken_over;
  double removed_mm3 = 0;
  /// Every brick in which the bone may differ from the scan, as it is at the beginning.
  std::vector<DensityBlock> bricks;
  /// Not empty: it began in the recording of this name in the same folder, which ends where this one begins;
  /// the rest means nothing then.
  std::string goes_on_from;
};

}  // namespace osteomill
