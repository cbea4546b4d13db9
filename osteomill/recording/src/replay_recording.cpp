#include "osteomill/recording/replay_recording.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/editable_volume.h"

#include "repeated_session.h"

namespace osteomill {

namespace {

std::string grid_text(const std::array<int, 3>& dims, const Vec3& spacing_mm) {
  return fmt::format("{} x {} x {} voxels of {:.6g} x {:.6g} x {:.6g} mm", dims[0], dims[1], dims[2],
                     spacing_mm.x(), spacing_mm.y(), spacing_mm.z());
}

// Throws if the number of guarded structures differs from the recorded one.
void require_guards(const Volume& scan, const Recording& recording) {
  const auto* recorded = find_setting<double>(recording.description, kGuardsKey);
  const double had = recorded != nullptr ? *recorded : 0;
  const int guards = scan.no_go() ? count_guards(*scan.no_go()) : 0;
  if (had != guards)
    refuse(recording,
           fmt::format("was recorded with {:g} guarded structures, not {}; open it with the same exercise",
                       had, guards));
}

// Applies the session's initial bone state to the scan.
void begin_at(const SessionStart& start, Volume& bone) {
  EditableVolume edited(bone);
  edited.set_isovalue(start.run.isovalue);
  for (DensityBlock brick : start.bricks) edited.swap(brick);
}

std::unique_ptr<MillingSession> session_at(const Volume& scan, const SessionStart& start,
                                           const Recording& recording, const ReplayHooks& hooks) {
  const RunDescription& run = start.run;
  const AlgorithmDescription* algorithm = hooks.find_algorithm(run.algorithm.name);
  if (algorithm == nullptr)
    refuse(recording,
           "its algorithm " + run.algorithm.name + " is not known; replay it with the program that made it");
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
    // A replay may lack the exercise's structures, and recordings of earlier programs may lack the column.
    if (column.has(kMayBeAbsent) &&
        (then == TickRecord::kNotRecorded || std::isnan(then) || std::isnan(again)))
      continue;
    if (std::bit_cast<std::uint64_t>(then) == std::bit_cast<std::uint64_t>(again)) continue;
    return fmt::format("{} is {}, recorded {} (difference {:.3g})", column.name, again, then, again - then);
  }
  return std::nullopt;
}

void repeat_session(Volume& volume, const Recording& recording, std::size_t number,
                    const OnRepeatedTick& on_tick) {
  const std::size_t first = recording.sessions[number].first;
  begin_at(recording.sessions[number].start, volume);
  RepeatedSession session(volume, recording, number, first);
  for (std::size_t tick = first; tick < session_end(recording, number); ++tick) {
    VolumeChange change = session.mill_next();
    if (tick == first) change.voxels = volume.geometry().all_voxels();
    if (on_tick) on_tick(tick, volume, change);
  }
}

// Runs the ticks from `row` on, starting in `session` if `row` is not a session's first tick. Returns the
// last session.
std::unique_ptr<MillingSession> run_from(std::size_t row, std::unique_ptr<MillingSession> session,
                                         const Volume& scan, const Recording& recording,
                                         const ReplayHooks& hooks) {
  for (std::size_t n = 0; n < recording.sessions.size(); ++n) {
    const std::size_t first = recording.sessions[n].first;
    if (first >= row) {
      SessionStart start = recording.sessions[n].start;
      if (hooks.transform_description) start.run = hooks.transform_description(start.run);
      session = session_at(scan, start, recording, hooks);
      if (hooks.on_session) hooks.on_session(start, *session);
    }
    for (std::size_t tick = std::max(first, row); tick < session_end(recording, n); ++tick) {
      const TickRecord& recorded = recording.records[tick];
      TickRecord now = replay_tick(*session, recorded);
      now.session = recorded.session;
      if (!hooks.on_tick(recorded, now)) return session;
    }
  }
  return session;
}

// Compares the ticks of a replay with the recording until one differs or `max_ticks` were equal.
class Comparison {
 public:
  Comparison(const Recording& recording, std::size_t max_ticks,
             const std::function<void(std::size_t ticks)>& on_progress)
      : recording_(recording),
        max_ticks_(max_ticks),
        on_progress_(on_progress),
        hash_(recording.bone_hashes.begin()) {}

  // Returns whether to continue.
  bool add(const TickRecord& recorded, const TickRecord& now) {
    auto what = difference_of(recorded, now);
    const bool has_hash = hash_ != recording_.bone_hashes.end() && hash_->record == verified_.ticks;
    if (!what && has_hash && hash_->hash != now.bone_hash) what = "the bone differs";
    if (what) {
      verified_.difference = {verified_.ticks, recorded.time_s, *std::move(what)};
      return false;
    }
    if (has_hash) {
      ++hash_;
      ++verified_.compared_bones;
    }
    ++verified_.ticks;
    if (on_progress_) on_progress_(verified_.ticks);
    return verified_.ticks < max_ticks_;
  }
  const Verification& verified() const { return verified_; }

 private:
  const Recording& recording_;
  std::size_t max_ticks_;
  const std::function<void(std::size_t ticks)>& on_progress_;
  std::vector<BoneHash>::const_iterator hash_;
  Verification verified_;
};

void require_replayable(const Volume& scan, const Recording& recording) {
  require_complete(recording);
  if (recording.records.empty()) refuse(recording, "holds no ticks");
  require_made_with(recording, scan);
  require_guards(scan, recording);
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
  require_replayable(scan, recording);
  run_from(0, nullptr, scan, recording, hooks);
}

std::string Difference::sentence() const {
  return fmt::format("differs from tick {} on ({:.3f} s): {}", record, time_s, what);
}

Verification verify_recording(const Volume& scan, const Recording& recording,
                              const std::function<void(std::size_t ticks)>& on_progress) {
  Comparison comparison(recording, recording.records.size(), on_progress);
  ReplayHooks hooks;
  hooks.on_tick = [&](const TickRecord& recorded, const TickRecord& now) {
    return comparison.add(recorded, now);
  };
  replay_recording(scan, recording, hooks);
  return comparison.verified();
}

std::size_t ticks_until(const Recording& recording, double time_s) {
  // Tolerance for times entered by users, who give at most six decimals.
  constexpr double kRounding_s = 1e-6;
  const std::vector<TickRecord>& records = recording.records;
  if (records.empty()) refuse(recording, "holds no ticks");
  const double begin_s = records.front().time_s, end_s = records.back().time_s + records.back().dt_s;
  if (!(time_s >= begin_s - kRounding_s && time_s <= end_s + kRounding_s))
    refuse(recording, fmt::format("has no tick at {:g} s; choose a time from {:.3f} to {:.3f} s", time_s,
                                  begin_s, end_s));
  const auto after = std::ranges::upper_bound(records, time_s + kRounding_s, {}, &TickRecord::time_s);
  // At least 1, even if the times in the file are not sorted.
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - records.begin(), 1));
}

ResumedRecording resume_recording(const Volume& scan, const Recording& recording, double time_s,
                                  const std::function<void(std::size_t ticks)>& on_progress) {
  require_replayable(scan, recording);
  const std::size_t ticks = ticks_until(recording, time_s);
  Comparison comparison(recording, ticks, on_progress);
  ReplayHooks hooks;
  hooks.on_tick = [&](const TickRecord& recorded, const TickRecord& now) {
    return comparison.add(recorded, now);
  };
  auto session = run_from(0, nullptr, scan, recording, hooks);
  if (const auto& difference = comparison.verified().difference) refuse(recording, difference->sentence());
  const TickRecord& last = recording.records[ticks - 1];
  return {std::move(session), ticks, last, recording.sessions[last.session].start.piece_drops};
}

void replay_rest(ResumedRecording resumed, const Volume& scan, const Recording& recording,
                 const ReplayHooks& hooks) {
  run_from(resumed.ticks, std::move(resumed.session), scan, recording, hooks);
}

void repeat_milling(Volume& volume, const Recording& recording, const OnRepeatedTick& on_tick) {
  require_made_with(recording, volume);
  require_complete(recording);
  const Volume scan = volume;
  for (std::size_t n = 0; n < recording.sessions.size(); ++n) {
    if (n > 0) volume = scan;
    repeat_session(volume, recording, n, on_tick);
  }
  EditableVolume(volume).set_isovalue(scan.isovalue());
}

}  // namespace osteomill
