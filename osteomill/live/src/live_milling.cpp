#include "osteomill/live/live_milling.h"

#include <chrono>
#include <thread>
#include <utility>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/editable_volume.h"

namespace osteomill {

namespace {

using namespace std::chrono_literals;

void add_picture(Recorder& recorder, std::string_view name, const LiveMilling::TakePicture& take) {
  if (!take) return;
  if (auto png = take(name)) recorder.add_picture(std::string(name), *std::move(png));
}

SessionSettings settings_of(const MillingSession& session) {
  return {session.setup(), session.densities()};
}

}  // namespace

PreparedMilling prepare_milling(std::shared_ptr<Volume> bone, const MillingSetup& setup,
                                const SessionStart& before) {
  BoneDensities densities;
  std::unique_ptr<BoneFollower> follower;
  const std::uint64_t scan_hash = fingerprint_of(bone->grid());
  if (!before.bricks.empty() &&
      (before.run.dims != bone->geometry().dims || before.run.scan_hash != scan_hash)) {
    throw InputError(before.run.scan_name,
                     "has changed since it was milled, so what was milled cannot be put into it");
  }
  {
    const WorkProgress::Part looking(0.2);
    densities = estimate_densities(*bone);
  }
  {
    const WorkProgress::Part meshing(0.8);
    follower = std::make_unique<BoneFollower>(bone);
  }
  follower->load_milled(before.bricks, before.piece_drops);
  const WorkProgress::Part preparing(1);
  auto session = std::make_unique<MillingSession>(std::move(bone), densities, setup);
  session->count_removed_from(before.removed_mm3);
  return {scan_hash, std::move(follower), std::move(session)};
}

PreparedMilling prepare_milling(std::shared_ptr<Volume> bone, const ResumedRecording& from,
                                const GuardSettings& guard) {
  const MillingSession& before = *from.session;
  const std::uint64_t scan_hash = fingerprint_of(bone->grid());
  const std::vector<DensityBlock> milled = differing_blocks(before.volume().grid(), bone->grid());
  EditableVolume(*bone).set_isovalue(before.volume().isovalue());
  std::unique_ptr<BoneFollower> follower;
  {
    const WorkProgress::Part meshing(0.8);
    follower = std::make_unique<BoneFollower>(bone);
  }
  follower->load_milled(milled, from.piece_drops);
  const WorkProgress::Part preparing(1);
  MillingSetup setup = before.setup();
  setup.guard = guard;
  auto session = std::make_unique<MillingSession>(std::move(bone), before.densities(), setup);
  session->count_removed_from(before.removed_mm3());
  // No tool pose if the device had not yet returned one.
  const SessionHandover handover{before.handover().X_WT, {}, true, before.handover().spindle_rpm};
  session->resume_from(handover);
  return {scan_hash, std::move(follower), std::move(session), handover, from.last.time_s + from.last.dt_s};
}

LiveMilling::LiveMilling(PreparedMilling prepared, Device& device)
    : sample_points_(prepared.session->algorithm().sample_point_count()),
      scan_hash_(prepared.scan_hash),
      initial_handover_(prepared.handover),
      follower_(std::move(prepared.follower)),
      live_(std::move(prepared.session), device, {}, prepared.time_s) {
  set_listener();
  if (initial_handover_.X_WT) live_.place(*initial_handover_.X_WT);
}

void LiveMilling::set_listener() {
  live_.set_listener([follower = follower_.get(), recorder = recorder_.get(), from = first_recorded_session_](
                         const TickRecord& record, const Volume& bone, const VolumeChange& change) {
    follower->bone_changed(bone, change);
    if (recorder != nullptr && record.session >= from) recorder->push(record);
  });
}

void LiveMilling::start() {
  const std::lock_guard lock(no_tick_mutex_);
  live_.start();
}

void LiveMilling::update() {
  if (is_preparing() && preparation_.wait_for(0s) == std::future_status::ready) install_prepared();
}

void LiveMilling::finish_preparing() {
  if (is_preparing()) install_prepared();
}

void LiveMilling::set_spindle(bool on) {
  if (on && !spindle_) follower_->begin_cut(live_.state().record.removed_mm3);
  spindle_ = on;
  live_.set_spindle(on);
}

bool LiveMilling::change(const MillingSetup& setup) {
  return prepare(setup, [this] {
    return BoneFollower::NextBone{live_.session().shared_volume(), live_.session().removed_mm3(), {}};
  });
}

bool LiveMilling::change_isovalue(double isovalue) {
  return prepare(setup(), [this, isovalue, surroundings = densities().surroundings] {
    return follower_->with_isovalue(isovalue, surroundings, live_.session().removed_mm3());
  });
}

bool LiveMilling::undo() {
  return prepare(setup(), [this] { return follower_->without_last_cut(live_.session().removed_mm3()); });
}

bool LiveMilling::redo() {
  return prepare(setup(), [this] { return follower_->with_undone_cut(live_.session().removed_mm3()); });
}

bool LiveMilling::reset() {
  return prepare(setup(), [this] { return follower_->without_all_cuts(); });
}

bool LiveMilling::remove_pieces(const PieceRemoval& removal) {
  return prepare(
      setup(), [this, removal] { return follower_->without_pieces(removal, live_.session().removed_mm3()); });
}

// A changed bone is made from the follower's copy, which can be written while the haptic thread uses the
// bone.
bool LiveMilling::prepare(const MillingSetup& setup, MakeBone make_bone) {
  if (is_preparing()) return false;
  const auto work = [this, make_bone = std::move(make_bone), setup] {
    catch_up();
    bool other_bone = true;
    try {
      const BoneFollower::NextBone next = make_bone();
      other_bone = next.bone != live_.session().shared_volume();
      auto session = std::make_unique<MillingSession>(next.bone, next.densities.value_or(densities()), setup);
      session->count_removed_from(next.removed_mm3);
      return Prepared{std::move(session), other_bone};
    } catch (...) {
      if (other_bone) follower_->discard_next();
      throw;
    }
  };
  live_.freeze_bone(true);
  try {
    preparation_ = std::async(std::launch::async, work);
  } catch (...) {
    live_.freeze_bone(false);
    throw;
  }
  return true;
}

void LiveMilling::catch_up() {
  while (!follower_->catch_up()) {
    {
      const std::lock_guard lock(no_tick_mutex_);
      // Without ticks, hand over on behalf of the haptic thread.
      if (!live_.is_running()) follower_->bone_changed(live_.session().volume(), {});
    }
    std::this_thread::sleep_for(1ms);
  }
}

void LiveMilling::install_prepared() {
  std::exception_ptr failure;
  try {
    Prepared prepared = preparation_.get();
    sample_points_ = prepared.session->algorithm().sample_point_count();
    const SessionHandover left = live_.replace(std::move(prepared.session));
    if (prepared.other_bone) follower_->swap();
    if (recorder_) record_session_start(left);
  } catch (...) {
    failure = std::current_exception();
  }
  live_.freeze_bone(false);
  if (!failure) return;
  drop_recorder_without_session();
  std::rethrow_exception(failure);
}

// Drops a recording whose first session could not be prepared, because it would be empty.
void LiveMilling::drop_recorder_without_session() {
  if (!recorder_ || live_.session_number() >= first_recorded_session_) return;
  const std::unique_ptr<Recorder> unused = std::move(recorder_);
  take_picture_ = {};
  set_listener();
}

std::vector<double> LiveMilling::removed_by_label() const {
  std::vector<double> removed_mm3 = follower_->drops_by_label();
  for (double& drop : removed_mm3) {
    drop /= densities().reference - densities().surroundings;
  }
  return removed_mm3;
}

RunDescription LiveMilling::describe(const std::string& scan_name, const std::string& command_line) const {
  const MillingSession& session = live_.session();
  return describe_run(session.volume(), {scan_name, scan_hash_}, settings_of(session), sample_points_,
                      command_line);
}

std::string LiveMilling::start_recording(const std::filesystem::path& path, RunDescription description,
                                         TakePicture picture) {
  finish_preparing();
  describe_current(description);
  auto recorder =
      std::make_unique<Recorder>(path, description, Recorder::FirstSession::begins_when_announced);
  add_picture(*recorder, kPictureBefore, picture);
  recorder_ = std::move(recorder);
  recorder_path_ = path;
  take_picture_ = std::move(picture);
  recorded_ = std::move(description);
  const bool untouched = !live_.is_running() && live_.timing().ticks == 0;
  first_recorded_session_ = untouched ? live_.session_number() : live_.session_number() + 1;
  if (untouched) record_session_start(initial_handover_);
  set_listener();
  std::string kept = recorder_->leftover_note();
  try {
    [[maybe_unused]] const bool begun = untouched || change(setup());
  } catch (...) {
    drop_recorder_without_session();
    throw;
  }
  return kept;
}

void LiveMilling::describe_current(RunDescription& run) const {
  run.isovalue = isovalue();
  set_session_settings(run, settings_of(live_.session()), sample_points_);
}

// Call only while nothing is milled.
void LiveMilling::record_session_start(const SessionHandover& handover) {
  RunDescription run = recorded_;
  describe_current(run);
  recorder_->begin_session(live_.session_number(), {.run = std::move(run),
                                                    .handover = handover,
                                                    .removed_mm3 = live_.session().removed_mm3(),
                                                    .bricks = follower_->touched_bricks(),
                                                    .piece_drops = follower_->piece_drops()});
}

std::filesystem::path LiveMilling::stop_recording() {
  // Start a recording that was stopped before its first session was installed.
  if (live_.session_number() < first_recorded_session_) finish_preparing();
  const std::unique_ptr<Recorder> recorder = std::move(recorder_);
  set_listener();
  for (const auto name : {kPictureAfter, kPictureAlong}) add_picture(*recorder, name, take_picture_);
  take_picture_ = {};
  recorder->close();
  return recorder_path_;
}

}  // namespace osteomill
