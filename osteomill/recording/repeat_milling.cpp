#include "osteomill/recording/repeat_milling.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/cutting_reaction.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/recording/session_settings.h"

namespace osteomill {

namespace {

[[noreturn]] void refuse(const Recording& recording, const std::string& reason) {
  throw InputError(recording.path.string(), reason);
}

BurrMill make_mill(const Recording& recording, const RunDescription& run, const SessionSettings& settings,
                   const GridGeometry& geometry) {
  try {
    return BurrMill(geometry, run.tool.burr_radius_mm, settings.densities, settings.milling);
  } catch (const std::invalid_argument& error) {
    refuse(recording, fmt::format("cannot be repeated: {}", error.what()));
  }
}

void require_same_removal(const Recording& recording, std::size_t tick, double removed_mm3) {
  const double recorded_mm3 = recording.records[tick].removed_mm3;
  if (removed_mm3 == recorded_mm3) return;
  if (tick == 0) {
    refuse(recording, fmt::format("goes on from other milling: {:.6g} mm^3 had been removed when it began",
                                  recorded_mm3));
  }
  refuse(recording, fmt::format("was made with another scan ({}) or version ({}): at tick {} it had removed "
                                "{:.9g} mm^3, where this one loses {:.9g}",
                                recording.description.scan_name, recording.description.program_version, tick,
                                recorded_mm3, removed_mm3));
}

// Of version 2, whose recordings hold one session and begin with the scan.
std::vector<RecordedSession> sessions_of(const Recording& recording) {
  if (!recording.sessions.empty()) return recording.sessions;
  return {{0, {recording.description, {}, 0, {}, ""}}};
}

void repeat_session(Volume& volume, const Recording& recording, const RecordedSession& session,
                    std::size_t end) {
  const SessionStart& start = session.start;
  const SessionSettings settings = session_settings(start.run, recording.path);
  BurrMill mill = make_mill(recording, start.run, settings, volume.geometry());
  volume.set_isovalue(start.run.isovalue);
  for (DensityBlock brick : start.bricks) swap_densities(volume, brick);
  double removed_mm3 = start.removed_mm3;
  for (std::size_t tick = session.first; tick < end; ++tick) {
    const TickRecord& record = recording.records[tick];
    if (!record.paused) {
      const Vec3 paying_W_N =
          paying_force_W_N(settings.milling, record.X_WT, record.burr_force_W_N, record.spindle_on);
      removed_mm3 += mill.step(volume, record.X_WT.position_mm, paying_W_N, record.dt_s).removed_mm3;
    }
    require_same_removal(recording, tick, removed_mm3);
  }
}

}  // namespace

void repeat_milling(Volume& volume, const Recording& recording) {
  require_made_with(recording, volume);
  if (recording.dropped > 0) {
    refuse(recording, fmt::format("lost {} ticks, so its milling cannot be repeated", recording.dropped));
  }
  const Volume scan = volume;
  const std::vector<RecordedSession> sessions = sessions_of(recording);
  if (const std::string& before = sessions.front().start.goes_on_from; !before.empty())
    refuse(recording, "goes on from other milling, that of " + before);
  for (std::size_t n = 0; n < sessions.size(); ++n) {
    if (n > 0) volume = scan;
    repeat_session(volume, recording, sessions[n],
                   n + 1 < sessions.size() ? sessions[n + 1].first : recording.records.size());
  }
  volume.set_isovalue(scan.isovalue());
}

}  // namespace osteomill
