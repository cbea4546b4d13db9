#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "osteomill/exercise/exercise.h"

namespace osteomill {

bool AllowedBurr::is_in(const MillingSetup& setup) const {
  constexpr double kSame_mm = 1e-6;
  if (named != nullptr) return setup.tool == named->tool && setup.burr == named->edge;
  return std::abs(setup.tool.burr_radius_mm - radius_mm) <= kSame_mm;
}

void AllowedBurr::put_into(MillingSetup& setup) const {
  constexpr double kShaftShare = 0.6;
  if (named != nullptr) {
    setup.tool = named->tool;
    setup.burr = named->edge;
    return;
  }
  setup.tool.burr_radius_mm = radius_mm;
  setup.tool.shaft_radius_mm = std::min(MillingTool{}.shaft_radius_mm, kShaftShare * radius_mm);
}

std::string AllowedBurr::label() const {
  return named != nullptr ? named->label : fmt::format("round {:g} mm", 2 * radius_mm);
}

}  // namespace osteomill
