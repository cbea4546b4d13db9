#include "app/simulate/playback_screen.h"

#include <algorithm>
#include <utility>

#include "app/simulate/panels.h"
#include "app/simulate/scene_of.h"

namespace osteomill::app {

PlaybackScreen::PlaybackScreen(std::unique_ptr<Playback> playback, double at_s, Stage& stage)
    : playback_(std::move(playback)) {
  ViewState& view = stage.view;
  view.message.clear();
  stage.voice.set({}, {});
  view.box = playback_->box();
  view.camera = initial_camera(view.box, stage.window.size());
  reset_cuts(view);
  const Volume& bone = playback_->work().bone.volume;
  stage.bone.show(playback_->follower().layout(), bone.geometry(), playback_->labels());
  if (at_s > 0) playback_->go_to_time(at_s);
}

void PlaybackScreen::draw(Stage& stage) {
  ViewState& view = stage.view;
  const PixelSize size = stage.window.size();
  const auto now = std::chrono::steady_clock::now();
  // Nothing is played while a file is being opened or the window is hidden.
  constexpr double kLongestPicture_s = 0.25;
  const std::chrono::duration<double> passed = now - std::exchange(played_, now);
  playback_->advance(std::min(passed.count(), kLongestPicture_s));
  if (playback_->is_following_recorded_view()) show_view(*playback_->view(), view);
  const Camera before = view.camera;
  take_view_input(view, size);
  if (view.camera != before) playback_->follow_recorded_view(false);
  stage.bone.take(playback_->take_changed_bricks(), stage.frames_per_s());
  stage.bone.update_cuts(view, playback_->follower(), playback_->grey_window(), nullptr);
  stage.bone.draw(scene_of(view, *playback_), size);
  draw_playback(view, *playback_, size);
}

}  // namespace osteomill::app
