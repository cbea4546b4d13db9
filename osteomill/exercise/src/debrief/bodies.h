#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "osteomill/exercise/attempt.h"
#include "osteomill/study/bone_page.h"
#include "osteomill/visual/camera.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Returns a ball about the target.
Sphere target_ball(const PlacedExercise& exercise);

/// Adds the bodies that a debriefing's page shows: the bone at the end, the target and what was left of it,
/// what was taken outside it, the bone to be kept, and each structure with the bone that was left over it.
/// Each is simplified until all have at most `max_vertices`. `colours` are those of `colours_of`. Long work.
void add_bodies(nlohmann::json& data, const Attempt& attempt, const LabelMap& colours,
                std::size_t max_vertices, const std::string& choice = {});

}  // namespace osteomill
