#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "osteomill/exercise/debriefing.h"

namespace osteomill {

/// Returns the progress of an attempt over time, as curves.
nlohmann::json curve_of(const std::vector<AttemptProgress>& progress);

/// Adds the course over time to a page's data: samples of the burr and the view, progress, moments, steps and
/// changes of the burr. `recording_name` is the recording's name for commands.
void put_course(nlohmann::json& data, const Attempt& attempt, const Recording& recording,
                const std::string& recording_name);

/// Adds the first attempt from where the other one branches off, with a mark there. `recording_name` is the
/// first attempt's.
void put_original_attempt(nlohmann::json& data, const OriginalAttempt& first,
                          const std::string& recording_name);

}  // namespace osteomill
