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

/// Throws InputError, naming the recording, if it was made with another scan than `scan`, which must be
/// unmilled.
void require_made_with(const Recording& recording, const Volume& scan);

/// Options and callbacks of a replay.
struct ReplayHooks {
  /// Looks up an algorithm by name.
  std::function<const AlgorithmDescription*(std::string_view)> find_algorithm = osteomill::find_algorithm;
  /// Optional: transforms the recorded description of each session before it is run.
  std::function<RunDescription(const RunDescription&)> transform_description;
  /// Called before the first tick of each session; may be empty.
  std::function<void(const SessionStart&, const MillingSession&)> on_session;
  /// Called after each tick with the recorded and the replayed record. Returns whether to continue.
  std::function<bool(const TickRecord& recorded, const TickRecord& now)> on_tick;
};

/// Replays the recording through the code of a live session: the inputs of device, spindle and operator come
/// from the recording, everything else is computed. Every session starts from its recorded bone, tool pose
/// and wrench. Throws InputError, naming the recording, if it was made with another scan, lost ticks, had
/// another number of guarded structures than `scan`, or if its algorithm or settings are unknown or out of
/// range.
void replay_recording(const Volume& scan, const Recording& recording, const ReplayHooks& hooks);

/// First tick in which a recording and its replay differ (Verification).
struct Difference {
  std::size_t record = 0;
  double time_s = 0;
  /// A clause such as "force_x_N is 1.5, recorded 1.25 (difference 0.25)".
  std::string what;
  /// Returns a full message: "differs from tick 12 on (0.012 s): ...".
  std::string sentence() const;
};

/// The result of `verify_recording`.
struct Verification {
  /// Number of equal ticks, and of those after which the bone was compared too.
  std::size_t ticks = 0;
  std::size_t compared_bones = 0;
  std::optional<Difference> difference;
};

/// Replays the recording and compares it bit for bit: the bone, and every tick except measured times.
/// `on_progress` receives the number of ticks done and may be empty. Throws as `replay_recording`.
Verification verify_recording(const Volume& scan, const Recording& recording,
                              const std::function<void(std::size_t ticks)>& on_progress = {});

/// Recording replayed up to one of its ticks, ready to be continued by other input.
struct ResumedRecording {
  /// Session in its state after that tick, bit for bit.
  std::unique_ptr<MillingSession> session;
  /// Number of ticks replayed, at least 1, and the last of them.
  std::size_t ticks = 0;
  TickRecord last;
  /// Densities removed with pieces before the last tick's session, mm^3 times density, per label
  /// (SessionStart::piece_drops).
  std::vector<double> piece_drops = {};
};

/// Returns the number of the recording's ticks that had begun by `time_s` (TickRecord::time_s). Throws
/// InputError, naming the recording, if that is before its first tick or after its end.
std::size_t ticks_until(const Recording& recording, double time_s);

/// Replays the recording up to `time_s`. Throws InputError as `replay_recording` and `ticks_until` do, and if
/// the replay is not bit-identical up to then. `on_progress` as for `verify_recording`. Long work.
ResumedRecording resume_recording(const Volume& scan, const Recording& recording, double time_s,
                                  const std::function<void(std::size_t ticks)>& on_progress = {});

/// Replays the recording's remaining ticks as `replay_recording` does.
void replay_rest(ResumedRecording resumed, const Volume& scan, const Recording& recording,
                 const ReplayHooks& hooks);

/// Called after each tick of `repeat_milling` with its index, the bone, and a box of voxels that may have
/// changed; for the first tick of a session that is the whole bone.
using OnRepeatedTick = std::function<void(std::size_t tick, const Volume& bone, const VolumeChange& change)>;

/// Repeats the recorded milling: `volume` is the scan as read, and afterwards the bone at the end of the
/// recording, bit for bit. Its isovalue is not used and is kept. Throws InputError, naming the recording, if
/// it was made with another scan, lost ticks, continues another recording, or lacks a milling setting; the
/// bone may then be partly milled. `on_tick` may be empty. Not for the tick.
void repeat_milling(Volume& volume, const Recording& recording, const OnRepeatedTick& on_tick = {});

}  // namespace osteomill
