#include "app/simulate/playback.h"

#include <algorithm>
#include <exception>
#include <functional>

#include <fmt/core.h>

#include "osteomill/base/work_progress.h"

namespace osteomill::app {

namespace {

// Returns the intervals in which `holds` is true, merging gaps shorter than kGap_s.
PlaybackMarks::Spans spans_of(const Recording& recording, const std::function<bool(std::size_t)>& holds) {
  constexpr double kGap_s = 0.05;
  PlaybackMarks::Spans spans;
  for (std::size_t n = 0; n < recording.records.size(); ++n) {
    if (!holds(n)) continue;
    const double time_s = recording.records[n].time_s;
    if (spans.empty() || time_s - spans.back().second > kGap_s) spans.emplace_back(time_s, time_s);
    spans.back().second = time_s;
  }
  return spans;
}

bool touches_no_go(const Recording& recording, const TickRecord& record) {
  if (record.no_go_distance_mm <= 0) return record.spindle_on;
  return std::ranges::any_of(record.label_cuts, [&](const LabelCut& cut) {
    return cut.label != 0 && recording.description.labels[cut.label - 1u].no_go;
  });
}

bool is_held_off(const WatchedStructure& structure, const Recording& recording, const TickRecord& record) {
  // Penetration from which a guard can be felt.
  constexpr double kFelt_mm = 0.05;
  const double radius_mm = recording.sessions[record.session].start.run.tool.burr_radius_mm;
  return !record.paused &&
         structure.distance.from(record.X_WT.position_mm) - radius_mm <= *structure.guard_mm + kFelt_mm;
}

std::string change_between(const RunDescription& before, const RunDescription& now) {
  if (before.tool.burr_radius_mm != now.tool.burr_radius_mm)
    return fmt::format("burr of {:g} mm", 2 * now.tool.burr_radius_mm);
  return before.algorithm == now.algorithm ? "bone or settings changed" : now.algorithm.name;
}

LoadedRecording with_ticks(LoadedRecording work) {
  ticks_until(work.recording, work.recording.records.empty() ? 0 : work.recording.records.front().time_s);
  return work;
}

std::vector<SessionSettings> settings_of(const Recording& recording) {
  std::vector<SessionSettings> settings;
  for (const RecordedSession& session : recording.sessions)
    settings.push_back(session_settings(session.start.run, recording.path));
  return settings;
}

}  // namespace

PlaybackMarks marks_of(const LoadedRecording& work) {
  const Recording& recording = work.recording;
  const std::vector<TickRecord>& records = recording.records;
  PlaybackMarks marks;
  marks.cuts = spans_of(recording, [&](std::size_t n) {
    // Across sessions the volume may grow because a cut was redone.
    return n > 0 && records[n].removed_mm3 > records[n - 1].removed_mm3 &&
           records[n].session == records[n - 1].session;
  });
  marks.contacts = spans_of(recording, [&](std::size_t n) { return records[n].contacts > 0; });
  marks.no_go = spans_of(recording, [&](std::size_t n) { return touches_no_go(recording, records[n]); });
  marks.faults = spans_of(recording, [&](std::size_t n) {
    return records[n].fault != WrenchFault::none && records[n].fault != WrenchFault::rate_limited;
  });
  for (std::size_t n = 0; work.placed && n < work.placed->distances->size(); ++n) {
    const WatchedStructure& structure = (*work.placed->distances)[n];
    if (!structure.guard_mm) continue;
    marks.guards.emplace_back(work.placed->structures[n].name, spans_of(recording, [&](std::size_t tick) {
                                return is_held_off(structure, recording, records[tick]);
                              }));
  }
  int step = 0;
  for (const ViewSample& view : recording.views)
    if (std::exchange(step, view.step) != view.step)
      marks.steps.emplace_back(view.time_s, fmt::format("step {}", view.step));
  for (std::size_t n = 1; n < recording.sessions.size(); ++n) {
    if (recording.sessions[n].first >= records.size()) break;
    marks.steps.emplace_back(
        records[recording.sessions[n].first].time_s,
        change_between(recording.sessions[n - 1].start.run, recording.sessions[n].start.run));
  }
  return marks;
}

Playback::Playback(LoadedRecording work)
    : work_(with_ticks(std::move(work))),
      marks_(marks_of(work_)),
      settings_(settings_of(work_.recording)),
      box_(box_of_bone(work_.bone.volume)),
      grey_window_(window_level_of(work_.bone.volume.grid(), settings_.front().densities.surroundings)),
      labels_(work_.placed ? colours_of(*work_.placed) : work_.bone.volume.labels()),
      bone_([&] {
        const WorkProgress::Part milling(0.8);
        return RecordedBone(work_.bone.volume, work_.recording);
      }()),
      follower_(std::make_shared<Volume>(work_.bone.volume), 0),
      isovalue_(work_.bone.volume.isovalue()) {
  go_to_tick(0);
  verified_ = std::async(std::launch::async, [this]() -> std::string {
                try {
                  const WorkProgress watched([this](double) {
                    if (stopped_) throw WorkStopped();
                  });
                  const Verification verified =
                      verify_recording(work_.bone.volume, work_.recording, [&](std::size_t ticks) {
                        checked_ = ticks;
                        if (stopped_) throw WorkStopped();
                      });
                  if (verified.difference) return "The replay " + verified.difference->sentence();
                  return fmt::format("Replay is bit-identical: {} ticks", verified.ticks);
                } catch (const std::exception& error) {
                  return error.what();
                }
              }).share();
}

Playback::~Playback() {
  stopped_ = true;
}

std::string Playback::verdict() const {
  if (is_verified()) return verified_.get();
  return fmt::format("Verifying the replay: {} of {} ticks", checked_.load(), recording().records.size());
}

const ViewSample* Playback::view() const {
  const auto after = std::ranges::upper_bound(recording().views, record().time_s, {}, &ViewSample::time_s);
  return after == recording().views.begin() ? nullptr : &*std::prev(after);
}

void Playback::go_to_tick(std::size_t tick) {
  bone_.go_to(std::min(tick, recording().records.size() - 1) + 1,
              [this](const VoxelBox& voxels) { follower_.bone_changed(bone_.bone(), {voxels}); });
  while (!follower_.catch_up()) follower_.bone_changed(bone_.bone(), {});
  if (const double now = bone_.bone().isovalue(); std::exchange(isovalue_, now) != now)
    follower_.show_isovalue(now);
  time_s_ = record().time_s;
}

void Playback::go_to_time(double time_s) {
  const double within_s = std::clamp(time_s, begin_s(), end_s());
  go_to_tick(ticks_until(recording(), within_s) - 1);
  time_s_ = within_s;
}

void Playback::advance(double passed_s) {
  if (!is_playing_) return;
  go_to_time(time_s_ + speed_ * passed_s);
  is_playing_ = time_s_ < end_s();
}

void Playback::play(bool on) {
  if (on && time_s_ >= end_s()) go_to_tick(0);
  is_playing_ = on;
}

void show_view(const ViewSample& sample, ViewState& view) {
  Camera& camera = view.camera;
  camera.orientation = sample.X_WC.orientation;
  camera.field_of_view_rad = sample.field_of_view_rad;
  const Vec3& eye_W = sample.X_WC.position_mm;
  camera.distance_mm = std::max(1.0, (eye_W - view.box.centre_W()).dot(camera.towards_viewer_W()));
  camera.focus_W = eye_W - camera.distance_mm * camera.towards_viewer_W();
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    const ViewClipPlane& cut = sample.cuts[n];
    view.cuts[n] = {!cut.normal_W.isZero(), false, cut.normal_W, static_cast<float>(cut.offset_mm)};
  }
}

}  // namespace osteomill::app
