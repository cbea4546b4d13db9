#pragma once

#include <chrono>
#include <memory>

#include "app/simulate/playback.h"
#include "app/simulate/stage.h"

namespace osteomill::app {

/// A recording in the window while it is played; nothing is milled meanwhile. One at a time on a stage.
class PlaybackScreen {
 public:
  /// Shows the recording at this time of it, s.
  PlaybackScreen(std::unique_ptr<Playback> playback, double at_s, Stage& stage);

  const Playback& playback() const { return *playback_; }
  /// Plays on by the time since the last picture, and draws.
  void draw(Stage& stage);
  /// Returns whether all is drawn and the recording was verified.
  bool is_settled(const Stage& stage) const { return stage.bone.is_up_to_date() && playback_->is_verified(); }

 private:
  std::unique_ptr<Playback> playback_;
  std::chrono::steady_clock::time_point played_ = std::chrono::steady_clock::now();
};

}  // namespace osteomill::app
