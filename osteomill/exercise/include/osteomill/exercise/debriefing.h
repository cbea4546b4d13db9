#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "osteomill/exercise/attempt.h"
#include "osteomill/exercise/measures.h"
#include "osteomill/recording/recording.h"

namespace osteomill {

/// An attempt as tables and curves need it, without its bone and ticks.
struct DebriefedAttempt {
  /// The recording as the user named it, and its trainee; empty if names are left out, or if none was given.
  std::string recording;
  std::string trainee;
  std::string date_utc;
  /// Whether guidance was shown when it began, and whether the recording was closed.
  bool has_guidance = false;
  bool is_complete = true;
  std::vector<MeasuredValue> rows;
  std::vector<AttemptProgress> progress;
};

/// Measures an attempt. `recording` is the one that the attempt was made of.
DebriefedAttempt debriefed(const Attempt& attempt, const Recording& recording);

/// An attempt from a tick of which another one goes on.
struct FirstWay {
  Attempt attempt;
  DebriefedAttempt measured;
  BranchPoint from;
};

/// The attempts with which an attempt's page compares it; all may be empty.
struct DebriefPeers {
  /// The one that it goes on from, or why that is not shown.
  std::shared_ptr<FirstWay> first;
  std::string no_first;
  std::vector<DebriefedAttempt> experts;
  /// The attempts of the same person before it, by time.
  std::vector<DebriefedAttempt> before;
};

/// Reads and measures the recording that an attempt goes on from (branch_point), by its name as seen from
/// that one or in its folder, and those of experts that the exercise's regions name. Throws as
/// `read_recording_chain` and `make_attempt` if one of an expert is at fault. The exercise and the scan of
/// `attempt` outlive the result. Long work.
DebriefPeers peers_of(const Attempt& attempt, const Recording& recording);

/// Writes an attempt's `debrief.csv`, `progress.csv` and `debrief.html`, a page that loads nothing from
/// anywhere, into a folder. Throws InputError if one cannot be written. Long work.
void write_debriefing(const std::filesystem::path& folder, const Attempt& attempt, const Recording& recording,
                      const DebriefedAttempt& own, const DebriefPeers& peers = {});

/// Writes the `debrief.csv` and `debrief.html` of the attempts of several persons at one exercise. `unread`
/// says why recordings are not among them, a line each. Throws as `write_debriefing`.
void write_class_debriefing(const std::filesystem::path& folder, const Exercise& exercise,
                            const std::vector<DebriefedAttempt>& attempts,
                            const std::vector<std::string>& unread);

/// The range in which the next attempt of a person lies in 19 of 20 cases if nothing changes.
struct Spread {
  double mean = 0;
  /// To either side of the mean; not a number if there are too few attempts.
  double width = 0;
};
/// Returns the 95 % prediction interval of a normal distribution from at least four values.
Spread spread_of(const std::vector<double>& before);

}  // namespace osteomill
