#pragma once

#include <chrono>

#include "osteomill/base/recent_rate.h"
#include "osteomill/visual/spindle_sound.h"

#include "app/simulate/bone_scene.h"
#include "app/simulate/files_panel.h"
#include "app/simulate/view_state.h"
#include "app/simulate/window.h"

namespace osteomill::app {

/// The spindle's sound and its present state.
struct SpindleAudio {
  SoundPlayer player;
  SpindleState state;

  void set(const SpindleState& heard, const BeatState& beat) { player.set(state = heard, beat); }
};

/// Everything shared by the screens of a window: start page, milling and playback.
struct Stage {
  Window window;
  ViewState view;
  FilesPanel files;
  BoneScene bone;
  SpindleAudio voice;
  RecentRate pictures;

  double frames_per_s() {
    return pictures.per_s(
        std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count());
  }
};

}  // namespace osteomill::app
