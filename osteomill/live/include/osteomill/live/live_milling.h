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

/// A bone prepared for milling, which takes seconds (prepare_milling()).
struct PreparedMilling {
  /// Fingerprint of the scan before any milling (fingerprint_of).
  std::uint64_t scan_hash = 0;
  std::unique_ptr<BoneFollower> follower;
  std::unique_ptr<MillingSession> session;
  /// If milling continues from a recording: the state taken from it, tool pose included, and the time of the
  /// first tick.
  SessionHandover handover = {};
  double time_s = 0;
};

/// Prepares milling, in any thread, also while another bone is milled. `bone` is the original scan; earlier
/// milling given by `before` can be undone as one cut. Throws std::invalid_argument for settings out of
/// range, and InputError, naming the scan, if `before` belongs to another scan.
PreparedMilling prepare_milling(std::shared_ptr<Volume> bone, const MillingSetup& setup,
                                const SessionStart& before = {});

/// Prepares milling that continues from a tick of a recording: with its bone, tool, settings, spindle speed
/// and time. `bone` is the original scan; the milling up to that tick can be undone as one cut. Because
/// another hand takes over, `guard` replaces the recorded protection settings, and forces are withheld until
/// the tool is placed at the recorded pose. Throws as the other overload does.
PreparedMilling prepare_milling(std::shared_ptr<Volume> bone, const ResumedRecording& from,
                                const GuardSettings& guard);

/// A bone that is milled in real time with a device, with everything that can be done to it meanwhile. Runs
/// the haptic thread; all functions are for one other thread. Long work (another algorithm or tool, undoing a
/// cut) runs on a thread of its own; meanwhile forces continue, but nothing is milled until `update` has
/// installed the result. If no thread can be created, the call throws std::system_error and changes nothing.
class LiveMilling {
 public:
  /// Takes ownership of the prepared milling. `device` outlives this object, and its handle must be where the
  /// tool may begin. If milling continues from a recording, the device is moved to the recorded tool pose.
  /// Does not start the thread.
  LiveMilling(PreparedMilling prepared, Device& device);
  LiveMilling(std::shared_ptr<Volume> bone, const MillingSetup& setup, Device& device)
      : LiveMilling(prepare_milling(std::move(bone), setup), device) {}

  /// Starts the haptic thread; throws as HapticThread::start does.
  void start();
  /// Stops the haptic thread; the device is sent zero.
  void stop() { live_.stop(); }
  bool is_running() const { return live_.is_running(); }
  /// Returns the exception with which the device ended the milling (HapticThread::failure).
  std::exception_ptr failure() const { return live_.failure(); }

  /// Installs a finished preparation. Call often, e.g. once per frame. Throws the exception of a failed
  /// preparation; milling then continues unchanged.
  void update();
  /// Blocks until preparation has finished and is installed. Throws as `update` does.
  void finish_preparing();
  bool is_preparing() const { return preparation_.valid(); }

  /// Switches the spindle. Switching it on begins another cut, a separate step for `undo`.
  void set_spindle(bool on);
  bool is_spindle_requested() const { return spindle_; }
  void set_paused(bool paused) { live_.set_paused(paused); }
  /// Moves the tool and its device to a pose free of bone (HapticThread::place).
  void place(const Pose& X_WD) { live_.place(X_WD); }
  bool is_placing() const { return live_.is_placing(); }
  /// Starts preparing another algorithm, tool or setting. Returns false and does nothing if a preparation is
  /// already under way; the caller retries once that is installed. The functions below return likewise.
  [[nodiscard]] bool change(const MillingSetup& setup);
  /// Starts preparing the bone at another isovalue; milled bone stays milled.
  [[nodiscard]] bool change_isovalue(double isovalue);
  /// Starts undoing the last cut.
  [[nodiscard]] bool undo();
  /// Starts redoing the last undone cut.
  [[nodiscard]] bool redo();
  /// Starts undoing all cuts.
  [[nodiscard]] bool reset();
  /// Starts removing pieces of the bone, which `undo` and `reset` restore. Does not count as milling: changes
  /// neither TickRecord::removed_mm3 nor `removed_by_label`. The preparation may throw as
  /// BoneFollower::without_pieces does.
  [[nodiscard]] bool remove_pieces(const PieceRemoval& removal);

  /// Returns the milled bone per label, mm^3 of reference density, indexed by label place (from 1). Excludes
  /// undone cuts. Empty for a bone without labels.
  std::vector<double> removed_by_label() const;

  /// Returns the description of the present state that a recording stores.
  RunDescription describe(const std::string& scan_name, const std::string& command_line) const;
  /// Takes the picture of the bone with this name (kPictureBefore and others) and returns its PNG;
  /// std::nullopt if the name is unknown.
  using TakePicture = std::function<std::optional<std::vector<unsigned char>>(std::string_view name)>;
  /// Starts a recording, which continues across changes and undone cuts. Blocks until a preparation has
  /// finished. If ticks have already run, prepares a new session with which the recorded ticks begin, so that
  /// the recording can be replayed by itself. Takes pictures now and at the end if `picture` is set. Returns
  /// a line on an unfinished earlier recording that was kept (Recorder::leftover_note). Throws InputError if
  /// the file cannot be written; then records nothing. Also records nothing if `update` or `finish_preparing`
  /// throws because that session cannot be prepared.
  std::string start_recording(const std::filesystem::path& path, RunDescription description,
                              TakePicture picture = {});
  /// Adds a view to the recording, if one is running (Recorder::add_view).
  void record_view(const ViewSample& view) {
    if (recorder_) recorder_->add_view(view);
  }
  /// Ends the recording and returns its name. Throws as Recorder::close does.
  std::filesystem::path stop_recording();
  bool is_recording() const { return recorder_ != nullptr; }
  /// Returns whether writing has failed (a full disk); `stop_recording` throws the reason. Milling continues.
  bool has_recording_failed() const { return recorder_ && recorder_->failed(); }

  const LiveState& state() { return live_.state(); }
  /// Returns the records of all ticks, one per call (HapticThread::next_record).
  std::optional<TickRecord> next_record() { return live_.next_record(); }
  TimingSummary timing() const { return live_.timing(); }
  const std::string& refused_real_time() const { return live_.refused_real_time(); }

  const MillingSetup& setup() const { return live_.session().setup(); }
  const BoneDensities& densities() const { return live_.session().densities(); }
  const GridGeometry& geometry() const { return live_.session().volume().geometry(); }
  double isovalue() const { return live_.session().volume().isovalue(); }

  /// Returns the follower of the bone, some ticks behind: surface, cuts and densities. Any thread.
  const BoneFollower& follower() const { return *follower_; }
  /// Returns the surface changes since the last call (BoneFollower::take_changed_bricks).
  ChangedBricks take_changed_bricks() { return follower_->take_changed_bricks(); }
  /// Requests remeshing of the surface at another isovalue (BoneFollower::show_isovalue).
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

  // Taken when the algorithm was prepared, because the points in use belong to the haptic thread and change.
  int sample_points_;
  std::uint64_t scan_hash_;
  SessionHandover initial_handover_;
  std::unique_ptr<BoneFollower> follower_;
  std::unique_ptr<Recorder> recorder_;
  std::filesystem::path recorder_path_;
  TakePicture take_picture_;
  // Description of the first recorded session.
  RunDescription recorded_;
  // Number of the first recorded session.
  std::uint32_t first_recorded_session_ = 0;
  HapticThread live_;
  // Held while starting and while handing over changes without a haptic thread, so that changes come from one
  // thread at a time.
  std::mutex no_tick_mutex_;
  // After `live_`, so that its destructor waits for the preparation while the haptic thread still runs.
  std::future<Prepared> preparation_;
  bool spindle_ = false;
};

}  // namespace osteomill
