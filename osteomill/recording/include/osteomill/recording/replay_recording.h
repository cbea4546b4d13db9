#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recording.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Throws InputError, naming the recording, if it was made with another scan than `scan`, which is as it was
/// read.
void require_made_with(const Recording& recording, const Volume& scan);

/// The choices for running a recording again, and the functions that are told of it.
struct ReplayHooks {
  /// Returns the algorithm of a name.
  std::function<const AlgorithmDescription*(std::string_view)> find_algorithm = osteomill::find_algorithm;
  /// Returns the description as which each session is run, given its own. If empty, each is run as it was.
  std::function<RunDescription(const RunDescription&)> transform_description;
  /// Is told of each session before its first tick; may be empty.
  std::function<void(const SessionStart&, const MillingSession&)> on_session;
  /// Is told of each tick, as it was and as it is now. Returns whether to go on.
  std::function<bool(const TickRecord& recorded, const TickRecord& now)> on_tick;
};

/// Runs the recording's ticks again through the same code as any session's: what the device, its spindle and
/// its operator did comes from the recording, all else is computed. Every session begins from the bone, the
/// tool and the wrench that it began from. Throws InputError, naming the recording, if that cannot be: it is
/// of another scan, lost ticks, held the burr off structures that `scan` does not have, or what it goes by is
/// unknown here or out of range.
void replay_recording(const Volume& scan, const Recording& recording, const ReplayHooks& hooks);

/// The first tick in which a recording and its replay differ (Verification).
struct Difference {
  std::size_t record = 0;
  double time_s = 0;
  /// In one clause: "force_x_N is 1.5 where 1.25 was recorded".
  std::string what;
  /// Returns all of it: "differs from tick 12 on (0.012 s): ...".
  std::string sentence() const;
};

/// The result of `verify_recording`.
struct Verification {
  /// The number of ticks that were the same, and that of those after which the bone was compared with the
  /// recording's.
  std::size_t ticks = 0;
  std::size_t compared_bones = 0;
  std::optional<Difference> difference;
};

/// Replays the recording and returns whether it comes out again bit for bit: everything of every tick except
/// times, and the bone. `on_progress` is told how many ticks are done; may be empty. Throws as
/// `replay_recording`.
Verification verify_recording(const Volume& scan, const Recording& recording,
                              const std::function<void(std::size_t ticks)>& on_progress = {});

/// A recording that was run again up to one of its ticks, from which somebody else may go on.
struct ResumedRecording {
  /// The session as it was after that tick, to the bit.
  std::unique_ptr<MillingSession> session;
  /// The number of the recording's ticks until then, at least 1, and the last of them.
  std::size_t ticks = 0;
  TickRecord last;
  /// The part of what is gone that was removed as pieces (SessionStart::piece_drops).
  std::vector<double> piece_drops = {};
};

/// Returns how many of the recording's ticks had begun at a time (TickRecord::time_s). Throws InputError,
/// naming the recording, if that is before its first tick or after its end.
std::size_t ticks_until(const Recording& recording, double time_s);

/// Replays the recording up to a time. Throws InputError, naming the recording, as `replay_recording` and
/// `ticks_until` do, and if it does not come out again bit for bit until then. `on_progress` as for
/// `verify_recording`. Long work.
ResumedRecording resume_recording(const Volume& scan, const Recording& recording, double time_s,
                                  const std::function<void(std::size_t ticks)>& on_progress = {});

/// Runs the recording's remaining ticks as `replay_recording` does.
void replay_rest(ResumedRecording resumed, const Volume& scan, const Recording& recording,
                 const ReplayHooks& hooks);

/// A function that is told of each tick of `repeat_milling`, after it: its index, the bone, and where that
/// may have changed. The first tick of a session may have changed all of it.
using OnRepeatedTick = std::function<void(std::size_t tick, const Volume& bone, const VolumeChange& change)>;

/// Mills the bone as the recording did: `volume` is the scan as it was when the recording began, and is
/// afterwards as it was when the recording ended, density by density; its isovalue plays no part and stays.
/// Throws InputError, naming the recording, if it was made with another scan, lost ticks, goes on from the
/// milling of another recording, or does not say how the bone was milled; the bone is then in part milled.
/// `on_tick`
/// may be empty. Not for the tick.
void repeat_milling(Volume& volume, const Recording& recording, const OnRepeatedTick& on_tick = {});

}  // namespace osteomill
