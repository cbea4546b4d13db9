#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "osteomill/live/bone_follower.h"
#include "osteomill/recording/recorded_bone.h"
#include "osteomill/recording/view_sample.h"
#include "osteomill/visual/camera.h"
#include "osteomill/visual/clip_face.h"

#include "app/branch_options.h"
#include "app/simulate/bone_view.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Times of a recording to mark, s.
struct PlaybackMarks {
  /// Start and end of each interval.
  using Spans = std::vector<std::pair<double, double>>;
  /// Intervals in which the burr cuts; the tool touches bone or a guard; it touches a no-go structure;
  /// another wrench than the requested one was sent (slow changes do not count).
  Spans cuts, contacts, no_go, faults;
  /// Intervals in which a guard held the burr off a structure, by the structure's name.
  std::vector<std::pair<std::string, Spans>> guards;
  /// Starts of exercise steps, and of sessions with another burr, algorithm or bone.
  std::vector<std::pair<double, std::string>> steps;
};
PlaybackMarks marks_of(const LoadedRecording& work);

/// A recording being played: without a haptic thread; shows the recorded data and repeats the milling on the
/// bone. Meanwhile another thread verifies the recording, as `replay --verify` does. For the window's thread.
class Playback {
 public:
  /// Opens the recording at its first tick. Throws InputError as RecordedBone does. Takes long; any thread.
  explicit Playback(LoadedRecording work);
  ~Playback();

  const LoadedRecording& work() const { return work_; }
  const Recording& recording() const { return work_.recording; }
  const PlaybackMarks& marks() const { return marks_; }
  double begin_s() const { return recording().records.front().time_s; }
  double end_s() const { return recording().records.back().time_s; }

  /// Returns the number of the current tick.
  std::size_t tick() const { return bone_.ticks() - 1; }
  const TickRecord& record() const { return recording().records[tick()]; }
  const SessionSettings& settings() const { return settings_[record().session]; }
  const RunDescription& run() const { return recording().sessions[record().session].start.run; }
  /// Returns the trainee's view at this time; null if none was recorded.
  const ViewSample* view() const;

  void go_to_tick(std::size_t tick);
  void go_to_time(double time_s);
  /// Advances the playback, if it is playing.
  void advance(double passed_s);
  bool is_playing() const { return is_playing_; }
  /// Starts playing, from the beginning if at the end, or pauses.
  void play(bool on);
  double speed() const { return speed_; }
  void set_speed(double speed) { speed_ = speed; }
  bool is_following_recorded_view() const { return follows_view_ && view() != nullptr; }
  void follow_recorded_view(bool on) { follows_view_ = on; }

  /// Returns whether the recording replays bit-identically, as far as it has been checked.
  std::string verdict() const;
  bool is_verified() const {
    return verified_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }

  const BoneFollower& follower() const { return follower_; }
  ChangedBricks take_changed_bricks() { return follower_.take_changed_bricks(); }
  const BoneBox& box() const { return box_; }
  const WindowLevel& grey_window() const { return grey_window_; }
  /// Returns the labels that colour the bone: the exercise's, or else the bone's own; null if there are none.
  const std::shared_ptr<const LabelMap>& labels() const { return labels_; }
  /// Returns whether the trainee saw the label colours.
  bool has_guidance() const { return view() == nullptr || view()->has_guidance; }

 private:
  LoadedRecording work_;
  PlaybackMarks marks_;
  std::vector<SessionSettings> settings_;
  BoneBox box_;
  WindowLevel grey_window_;
  std::shared_ptr<const LabelMap> labels_;
  RecordedBone bone_;
  BoneFollower follower_;
  double isovalue_;
  bool is_playing_ = false;
  bool follows_view_ = true;
  double speed_ = 1;
  double time_s_ = 0;
  std::atomic<std::size_t> checked_{0};
  std::atomic<bool> stopped_{false};
  std::shared_future<std::string> verified_;
};

/// Sets camera and cuts to those of a recorded view.
void show_view(const ViewSample& sample, ViewState& view);

}  // namespace osteomill::app
