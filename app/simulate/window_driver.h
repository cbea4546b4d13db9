#pragma once

#include <cstddef>

#include "osteomill/visual/spindle_sound.h"

#include "app/simulate/dialogues.h"
#include "app/simulate/files_panel.h"
#include "app/simulate/playback.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"
#include "app/simulate/window.h"

namespace osteomill::app {

/// Everything the window shows at the end of a frame.
struct WindowContents {
  const Window& window;
  ViewState& view;
  /// Null if no scan is open.
  Simulation* simulation;
  /// Null if no recording is played.
  const Playback* playback;
  const FilesPanel& files;
  const SpindleState& sound;
  double frames_per_s;
  std::size_t triangles;
};

/// Operates the window in place of a person. The program itself has none; the one of the tests reads a script
/// (tests/window/driver). All calls come from the window's thread.
class WindowDriver {
 public:
  WindowDriver() = default;
  WindowDriver(const WindowDriver&) = delete;
  WindowDriver& operator=(const WindowDriver&) = delete;
  virtual ~WindowDriver() = default;

  /// Returns whether to start while the first scan is still being opened.
  virtual bool is_started_before_scan() const = 0;
  /// Passes the input of the next frame to ImGui, `passed_s` after the last one. `is_settled` is true if
  /// nothing is being prepared, written or moved into place.
  virtual void inject_input(double passed_s, bool is_settled, Window& window) = 0;
  /// Inspects the window after ImGui has been drawn and before the frame is shown.
  virtual void read(const WindowContents& contents) = 0;
  /// Returns whether the window has to close without a question.
  virtual bool has_close_request() const = 0;
  /// Called once, after the last frame.
  virtual void finish() = 0;
};

}  // namespace osteomill::app
