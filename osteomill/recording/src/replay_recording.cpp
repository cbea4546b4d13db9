#include "osteomill/recording/replay_recording.h"

#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/cutting_reaction.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/editable_volume.h"

namespace osteomill {

namespace {

[[noreturn]] void refuse(const Recording& recording, const std::string& reason) {
  throw InputError(recording.path.string(), reason);
}

std::string grid_text(const std::array<int, 3>& dims, const Vec3& spacing_mm) {
  return fmt::format("{} x {} x {} voxels of {:.6g} x {:.6g} x {:.6g} mm", dims[0], dims[1], dims[2],
                     spacing_mm.x(), spacing_mm.y(), spacing_mm.z());
}

void require_whole(const Recording& recording) {
  if (recording.sessions.empty()) refuse(recording, "holds no ticks");
  if (recording.dropped > 0)
    refuse(recording, fmt::format("lost {} ticks, so they cannot be run again", recording.dropped));
  if (const std::string& before = recording.sessions.front().start.continues_from; !before.empty())
    refuse(recording, "goes on from " + before + ", without which it cannot be run again");
}

std::size_t end_of(const Recording& recording, std::size_t session) {
  return session + 1 < recording.sessions.size() ? recording.sessions[session + 1].first
                                                 : recording.records.size();
}

// From the scan.
void begin_at(const SessionStart& start, Volume& bone) {
  EditableVolume edited(bone);
  edited.set_isovalue(start.run.isovalue);
  for (DensityBlock brick : start.bricks) edited.swap(brick);
}

// Makes an object from settings that may be out of range.
template <typename Make>
auto made(const Recording& recording, const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    refuse(recording, fmt::format("cannot be run again: {}", error.what()));
  }
}

std::unique_ptr<MillingSession> session_at(const Volume& scan, const SessionStart& start,
                                           const Recording& recording, const ReplayHooks& hooks) {
  const RunDescription& run = start.run;
  const AlgorithmDescription* algorithm = hooks.find_algorithm(run.algorithm.name);
  if (algorithm == nullptr) refuse(recording, "its algorithm " + run.algorithm.name + " is not known here");
  auto [setup, densities] = session_settings(run, recording.path);
  setup.algorithm = *algorithm;
  auto bone = std::make_shared<Volume>(scan);
  return made(recording, [&, &setup = setup, &densities = densities] {
    begin_at(start, *bone);
    auto session = std::make_unique<MillingSession>(std::move(bone), densities, setup);
    session->count_removed_from(start.removed_mm3);
    session->resume_from(start.handover);
    return session;
  });
}

TickRecord replay_tick(MillingSession& session, const TickRecord& recorded) {
  PosedDevice device;
  device.put(recorded.X_WD, recorded.delivered_fraction, recorded.driven);
  if (recorded.fade_out) session.fade_out();
  if (recorded.placed) session.place();
  return session.tick(device, {.time_s = recorded.time_s,
                               .dt_s = recorded.dt_s,
                               .spindle_on = recorded.spindle_on,
                               .paused = recorded.paused});
}

std::optional<std::string> difference_of(const TickRecord& recorded, const TickRecord& now) {
  for (const Field<TickRecord>& column : fields_of<TickRecord>()) {
    if (column.has(kMeasuredTime)) continue;
    const double then = column.get(recorded);
    const double again = column.get(now);
    // A replay has no exercise's structures, and an earlier program no such column.
    if (column.has(kMayBeAbsent) &&
        (then == TickRecord::kNotRecorded || std::isnan(then) || std::isnan(again)))
      continue;
    if (std::bit_cast<std::uint64_t>(then) == std::bit_cast<std::uint64_t>(again)) continue;
    return fmt::format("{} is {} where {} was recorded (by {:.3g})", column.name, again, then, again - then);
  }
  return std::nullopt;
}

void require_same_removal(const Recording& recording, std::size_t tick, double removed_mm3) {
  const double recorded_mm3 = recording.records[tick].removed_mm3;
  if (removed_mm3 == recorded_mm3) return;
  if (tick == 0) {
    refuse(recording, fmt::format("goes on from other milling: {:.6g} mm³ had been removed when it began",
                                  recorded_mm3));
  }
  refuse(recording, fmt::format("was made with another scan ({}) or version ({}): at tick {} it had removed "
                                "{:.9g} mm³, where this one loses {:.9g}",
                                recording.description.scan_name, recording.description.program_version, tick,
                                recorded_mm3, removed_mm3));
}

void repeat_session(Volume& volume, const Recording& recording, std::size_t number,
                    const OnRepeatedTick& on_tick) {
  const auto& [first, start] = recording.sessions[number];
  const SessionSettings settings = session_settings(start.run, recording.path);
  const MillingSettings milling = milling_settings(settings.setup);
  BurrMill mill = made(recording, [&] {
    return BurrMill(volume, settings.setup.tool.burr_radius_mm, settings.densities, milling);
  });
  begin_at(start, volume);
  double removed_mm3 = start.removed_mm3;
  for (std::size_t tick = first; tick < end_of(recording, number); ++tick) {
    const TickRecord& record = recording.records[tick];
    VolumeChange change;
    if (!record.paused) {
      const Vec3 paying_W_N =
          paying_force_W_N(milling, record.X_WT, record.burr_force_W_N, record.spindle_on);
      const double speed_share =
          settings.setup.handpiece == Handpiece::none ? 1 : record.spindle_rpm / milling.spindle_speed_rpm;
      const MillingStep step = mill.step(record.X_WT.position_mm, paying_W_N, record.dt_s, speed_share);
      removed_mm3 += step.removed_mm3;
      change = step.change;
    }
    require_same_removal(recording, tick, removed_mm3);
    if (tick == first) change.voxels = volume.geometry().all_voxels();
    if (on_tick) on_tick(tick, volume, change);
  }
}

}  // namespace

void require_made_with(const Recording& recording, const Volume& scan) {
  const RunDescription& run = recording.description;
  const GridGeometry& geometry = scan.geometry();
  if (run.dims != geometry.dims || !run.spacing_mm.isApprox(geometry.spacing_mm, 1e-9)) {
    refuse(recording,
           fmt::format("was made with another scan ({}): {}, not {}", run.scan_name,
                       grid_text(run.dims, run.spacing_mm), grid_text(geometry.dims, geometry.spacing_mm)));
  }
  if (run.scan_hash != 0 && run.scan_hash != fingerprint_of(scan.grid()))
    refuse(recording, fmt::format("was made with another scan ({}): its densities differ", run.scan_name));
}

void replay_recording(const Volume& scan, const Recording& recording, const ReplayHooks& hooks) {
  require_whole(recording);
  if (recording.records.empty()) refuse(recording, "holds no ticks");
  require_made_with(recording, scan);
  for (std::size_t n = 0; n < recording.sessions.size(); ++n) {
    SessionStart start = recording.sessions[n].start;
    if (hooks.transform_description) start.run = hooks.transform_description(start.run);
    const auto session = session_at(scan, start, recording, hooks);
    if (hooks.on_session) hooks.on_session(start, *session);
    for (std::size_t row = recording.sessions[n].first; row < end_of(recording, n); ++row) {
      const TickRecord& recorded = recording.records[row];
      TickRecord now = replay_tick(*session, recorded);
      now.session = recorded.session;
      if (!hooks.on_tick(recorded, now)) return;
    }
  }
}

Verification verify_recording(const Volume& scan, const Recording& recording,
                              const std::function<void(std::size_t ticks)>& on_progress) {
  Verification verified;
  auto hash = recording.bone_hashes.begin();
  ReplayHooks hooks;
  hooks.on_tick = [&](const TickRecord& recorded, const TickRecord& now) {
    auto what = difference_of(recorded, now);
    const bool has_hash = hash != recording.bone_hashes.end() && hash->record == verified.ticks;
    if (!what && has_hash && hash->hash != now.bone_hash) what = "the bone is another";
    if (what) {
      verified.difference = {verified.ticks, recorded.time_s, *std::move(what)};
      return false;
    }
    if (has_hash) {
      ++hash;
      ++verified.compared_bones;
    }
    ++verified.ticks;
    if (on_progress) on_progress(verified.ticks);
    return true;
  };
  replay_recording(scan, recording, hooks);
  return verified;
}

void repeat_milling(Volume& volume, const Recording& recording, const OnRepeatedTick& on_tick) {
  require_made_with(recording, volume);
  require_whole(recording);
  const Volume scan = volume;
  for (std::size_t n = 0; n < recording.sessions.size(); ++n) {
    if (n > 0) volume = scan;
    repeat_session(volume, recording, n, on_tick);
  }
  EditableVolume(volume).set_isovalue(scan.isovalue());
}

}  // namespace osteomill
