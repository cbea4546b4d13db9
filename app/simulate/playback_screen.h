#pragma once

#include <chrono>
#include <memory>

#include "app/simulate/playback.h"
#include "app/simulate/stage.h"

namespace osteomill::app {

/// A recording being played in the window; nothing is milled meanwhile. Only one at a time on a stage.
class PlaybackScreen {
 public:
  /// Shows the recording at time `at_s`.
  PlaybackScreen(std::unique_ptr<Playback> playback, double at_s, Stage& stage);

  const Playback& playback() const { return *playback_; }
  /// Advances by the time since the last frame, and draws.
  void draw(Stage& stage);
  /// Returns whether everything is drawn and the recording is verified.
  bool is_settled(const Stage& stage) const { return stage.bone.is_up_to_date() && playback_->is_verified(); }

 private:
  std::unique_ptr<Playback> playback_;
  std::chrono::steady_clock::time_point played_ = std::chrono::steady_clock::now();
};

}  // namespace osteomill::app
