#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "osteomill/exercise/attempt.h"
#include "osteomill/study/bone_page.h"
#include "osteomill/visual/camera.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Returns a ball that contains the target.
Sphere target_ball(const PlacedExercise& exercise);

/// Adds the bodies of a debriefing's page: the bone at the end, the target and its remainder, the bone
/// removed outside it, the bone to be kept, and each structure with the thickness of the bone left over it.
/// Simplifies each so that together they have at most `max_vertices`. `colours` is from `colours_of`. Slow.
void add_bodies(nlohmann::json& data, const Attempt& attempt, const LabelMap& colours,
                std::size_t max_vertices, const std::string& choice = {});

}  // namespace osteomill
