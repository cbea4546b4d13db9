#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "osteomill/exercise/debriefing.h"

namespace osteomill {

/// Returns the product over time of an attempt, for curves.
nlohmann::json curve_of(const std::vector<AttemptProgress>& progress);

/// Puts what happened over time into a page's data: samples of the burr and of the view, product, moments,
/// steps and changes of the burr. `recording_name` is what the commands call the recording.
void put_course(nlohmann::json& data, const Attempt& attempt, const Recording& recording,
                const std::string& recording_name);

/// Adds the first way: how it went on from where the other one leaves it, and a mark there. `recording_name`
/// is that of the first way.
void put_first_way(nlohmann::json& data, const FirstWay& first, const std::string& recording_name);

}  // namespace osteomill
