#include "osteomill/live/spindle_state.h"

#include <algorithm>

namespace osteomill {

SpindleState spindle_state(const TickRecord& record, const MillingSetup& setup) {
  return {std::max(record.spindle_rpm, 0.0), sound_load(record.cutting_power_W),
          std::max(record.cut_density, 0.0),
          setup.law == CuttingLaw::chips && setup.burr == BurrEdge::diamond};
}

}  // namespace osteomill
