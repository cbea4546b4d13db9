#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "osteomill/exercise/attempt.h"
#include "osteomill/exercise/measures.h"
#include "osteomill/recording/recording.h"

namespace osteomill {

/// The results of an attempt for tables and curves, without its bone and ticks.
struct DebriefedAttempt {
  /// Recording as the user named it, and its trainee; empty if names are omitted or none was given.
  std::string recording;
  std::string trainee;
  std::string date_utc;
  /// Whether guidance was shown at the beginning, and whether the recording was closed.
  bool has_guidance = false;
  bool is_complete = true;
  std::vector<MeasuredValue> rows;
  std::vector<AttemptProgress> progress;
};

/// Measures an attempt. `recording` is its recording.
DebriefedAttempt debriefed(const Attempt& attempt, const Recording& recording);

/// The attempt from which another attempt branched off.
struct OriginalAttempt {
  Attempt attempt;
  DebriefedAttempt measured;
  BranchPoint from;
};

/// Attempts with which an attempt's page compares it; all may be empty.
struct DebriefPeers {
  /// The attempt it branched off from, or the reason why that is not shown.
  std::shared_ptr<OriginalAttempt> first;
  std::string original_missing_reason;
  std::vector<DebriefedAttempt> experts;
  /// Earlier attempts of the same person, by time.
  std::vector<DebriefedAttempt> before;
};

/// Reads and measures the recording that an attempt branched off from (branch_point), by its name relative to
/// that recording or in its folder, and the experts' recordings in the exercise's regions. Throws as
/// `read_recording_chain` and `make_attempt` for experts' recordings; for the first one, sets
/// `original_missing_reason` instead. The exercise and the scan of `attempt` must outlive the result. Slow.
DebriefPeers load_peers(const Attempt& attempt, const Recording& recording);

/// Writes an attempt's `debrief.csv`, `progress.csv` and `debrief.html`, a page without external resources,
/// into a folder. Throws InputError if one cannot be written. Slow.
void write_debriefing(const std::filesystem::path& folder, const Attempt& attempt, const Recording& recording,
                      const DebriefedAttempt& own, const DebriefPeers& peers = {});

/// Writes `debrief.csv` and `debrief.html` for attempts of several persons at one exercise. `unread` lists
/// the recordings that are missing, with the reason, one per line. Throws as `write_debriefing`.
void write_class_debriefing(const std::filesystem::path& folder, const Exercise& exercise,
                            const std::vector<DebriefedAttempt>& attempts,
                            const std::vector<std::string>& unread);

/// Range that contains a person's next attempt in 19 of 20 cases if nothing changes.
struct Spread {
  double mean = 0;
  /// Half width; NaN if there are too few attempts.
  double width = 0;
};
/// Returns the 95 % prediction interval of a normal distribution; its width needs at least four values.
Spread spread_of(const std::vector<double>& before);

}  // namespace osteomill
