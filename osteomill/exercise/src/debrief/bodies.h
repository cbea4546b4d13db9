#pragma once

#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "osteomill/exercise/attempt.h"
#include "osteomill/study/page.h"
#include "osteomill/visual/camera.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Returns numbers as a page's script reads them: their bytes in base 64.
template <typename Number>
nlohmann::json packed(const std::vector<Number>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
}

/// Returns a ball about the target.
Sphere target_ball(const PlacedExercise& exercise);

/// Returns the bodies that a debriefing's page shows: the bone at the end, the target and what was left of
/// it, what was taken outside it, the bone to be kept, and each structure with the bone that was left over
/// it. Each is simplified until it is small enough for a page. `colours` are those of `colours_of`. Long
/// work.
nlohmann::json bodies_of(const Attempt& attempt, const LabelMap& colours);

}  // namespace osteomill
