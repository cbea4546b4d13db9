#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/live/bone_follower.h"
#include "osteomill/live/haptic_thread.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/session/milling_setup.h"

namespace osteomill {

/// A bone made ready for milling, which takes seconds (prepare_milling()).
struct PreparedMilling {
  /// The fingerprint of the scan, before anything was milled (fingerprint_of).
  std::uint64_t scan_hash = 0;
  std::unique_ptr<BoneFollower> follower;
  std::unique_ptr<MillingSession> session;
  /// If it goes on from a recording: what the session took over from it, with the tool's pose, and the time
  /// of its first tick.
  SessionHandover handover = {};
  double time_s = 0;
};

/// Prepares milling, in any thread, also while another bone is milled. `bone` is as scanned; what was milled
/// of it `before`, if anything was, can be taken back as one cut. Throws std::invalid_argument for settings
/// out of range, and InputError, naming the scan, if `before` is of another scan.
PreparedMilling prepare_milling(std::shared_ptr<Volume> bone, const MillingSetup& setup,
                                const SessionStart& before = {});

/// Prepares milling that goes on from a tick of a recording: with the bone, the tool, the settings, the speed
/// of the spindle and the time of that tick. `bone` is as scanned; what is gone of it by then can be taken
/// back as one cut. The hand that takes over is another one, so it is protected by `guard` in the place of
/// the recorded settings, and held back until the tool is placed where it was. Throws as the other does.
PreparedMilling prepare_milling(std::shared_ptr<Volume> bone, const ResumedRecording& from,
                                const GuardSettings& guard);

/// A bone that is milled in real time with a device, and all that can be done to it meanwhile. It runs the
/// haptic thread; all of its functions are for one other thread. Work that takes long (another algorithm or
/// tool, undoing a cut) is done on a thread of its own: the tool goes on being felt, but nothing is milled
/// until `update` has put the result in place. If a thread is needed and the system gives none, the call
/// throws std::system_error and changes nothing.
class LiveMilling {
 public:
  /// Takes over what was prepared. `device` outlives this object; its handle is where the tool may begin. If
  /// it goes on from a recording, the device is put where the tool was then. Does not start yet.
  LiveMilling(PreparedMilling prepared, Device& device);
  LiveMilling(std::shared_ptr<Volume> bone, const MillingSetup& setup, Device& device)
      : LiveMilling(prepare_milling(std::move(bone), setup), device) {}

  /// Starts the haptic thread, as HapticThread::start does, failures included.
  void start();
  /// Stops the haptic thread; the device is sent zero.
  void stop() { live_.stop(); }
  bool is_running() const { return live_.is_running(); }
  /// Returns the exception with which the device ended the milling (HapticThread::failure).
  std::exception_ptr failure() const { return live_.failure(); }

  /// Puts in place what has been prepared. Has to be called often, as once a picture. Throws what a
  /// preparation failed with; milling goes on as it was.
  void update();
  /// Returns when nothing is being prepared any more. Throws as `update` does.
  void finish_preparing();
  bool is_preparing() const { return preparation_.valid(); }

  /// Switches the spindle. Switching it on begins another cut, which `undo` takes back by itself.
  void set_spindle(bool on);
  bool is_spindle_requested() const { return spindle_; }
  void set_paused(bool paused) { live_.set_paused(paused); }
  /// Brings the tool and its device to a pose free of bone (HapticThread::place).
  void place(const Pose& X_WD) { live_.place(X_WD); }
  bool is_placing() const { return live_.is_placing(); }
  /// Begins to prepare another algorithm, tool or setting. Returns false, as do the functions below, if
  /// something is being prepared already: then it does nothing, and the caller asks again once that is in
  /// place.
  [[nodiscard]] bool change(const MillingSetup& setup);
  /// Begins to prepare the bone at another isovalue; what was milled stays milled. Returns as `change` does.
  [[nodiscard]] bool change_isovalue(double isovalue);
  /// Begins to take the last cut back. Returns as `change` does.
  [[nodiscard]] bool undo();
  /// Begins to make the cut again that was taken back last. Returns as `change` does.
  [[nodiscard]] bool redo();
  /// Begins to take all cuts back. Returns as `change` does.
  [[nodiscard]] bool reset();
  /// Begins to remove pieces of the bone, which `undo` and `reset` bring back. It is no milling: it changes
  /// neither TickRecord::removed_mm3 nor `removed_by_label`. Returns as `change` does; what is prepared
  /// throws as BoneFollower::without_pieces.
  [[nodiscard]] bool remove_pieces(const PieceRemoval& removal);

  /// Returns how much of each label's bone was milled, mm^3 of reference density, by the labels' places from
  /// 1; what was taken back does not count. Empty for a bone without labels.
  std::vector<double> removed_by_label() const;

  /// Returns what a recording says about the milling as it is now.
  RunDescription describe(const std::string& scan_name, const std::string& command_line) const;
  /// Takes the picture of the bone with this name (kPictureBefore and the others) and returns its PNG;
  /// nothing if there is none of that name.
  using TakePicture = std::function<std::optional<std::vector<unsigned char>>(std::string_view name)>;
  /// Starts a recording, which goes on whatever is changed or taken back. Waits for what is being prepared.
  /// If ticks have run already, another session is prepared, so that the recording holds all that it takes to
  /// replay it, and its ticks begin with that session. Pictures, if `picture` is given, are taken now and at
  /// the end. Returns a line on an unfinished recording that was there and is kept (Recorder::leftover_note).
  /// Throws InputError if the file cannot be written; then nothing is recorded. Nothing is recorded either if
  /// `update` or `finish_preparing` throws because that session cannot be prepared.
  std::string start_recording(const std::filesystem::path& path, RunDescription description,
                              TakePicture picture = {});
  /// Adds a view to the recording, if there is one (Recorder::add_view).
  void record_view(const ViewSample& view) {
    if (recorder_) recorder_->add_view(view);
  }
  /// Ends the recording and returns its name. Throws as Recorder::close does.
  std::filesystem::path stop_recording();
  bool is_recording() const { return recorder_ != nullptr; }
  /// Returns whether writing has failed (a full disk); stop_recording says why. Milling goes on.
  bool has_recording_failed() const { return recorder_ && recorder_->failed(); }

  const LiveState& state() { return live_.state(); }
  /// Returns every tick in turn (HapticThread::next_record).
  std::optional<TickRecord> next_record() { return live_.next_record(); }
  TimingSummary timing() const { return live_.timing(); }
  const std::string& refused_real_time() const { return live_.refused_real_time(); }

  const MillingSetup& setup() const { return live_.session().setup(); }
  const BoneDensities& densities() const { return live_.session().densities(); }
  const GridGeometry& geometry() const { return live_.session().volume().geometry(); }
  double isovalue() const { return live_.session().volume().isovalue(); }

  /// Returns the bone as it is milled, some ticks behind: its surface, cuts and densities; from any thread.
  const BoneFollower& follower() const { return *follower_; }
  /// Returns what changed of the surface since the last call (BoneFollower::take_changed_bricks).
  ChangedBricks take_changed_bricks() { return follower_->take_changed_bricks(); }
  /// Lets the surface be meshed at another isovalue (BoneFollower::show_isovalue).
  void show_isovalue(double isovalue) { follower_->show_isovalue(isovalue); }

 private:
  struct Prepared {
    std::unique_ptr<MillingSession> session;
    bool other_bone;
  };
  using MakeBone = std::function<BoneFollower::NextBone()>;

  void set_listener();
  bool prepare(const MillingSetup& setup, MakeBone make_bone);
  void catch_up();
  void install_prepared();
  void drop_recorder_without_session();
  void describe_current(RunDescription& run) const;
  void record_session_start(const SessionHandover& handover);

  // The number as the algorithm was prepared: the points in use belong to the haptic thread, and change.
  int sample_points_;
  std::uint64_t scan_hash_;
  SessionHandover begun_from_;
  std::unique_ptr<BoneFollower> follower_;
  std::unique_ptr<Recorder> recorder_;
  std::filesystem::path recorder_path_;
  TakePicture take_picture_;
  // The recording's description of its first session.
  RunDescription recorded_;
  // The first session that is recorded.
  std::uint32_t recorded_from_ = 0;
  HapticThread live_;
  // Held to start, and to hand over changes while no haptic thread does: they come from one thread at a time.
  std::mutex no_tick_mutex_;
  // After `live_`, so that it is waited for while the bone is still milled.
  std::future<Prepared> preparation_;
  bool spindle_ = false;
};

}  // namespace osteomill
