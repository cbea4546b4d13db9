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

/// Everything that the window shows at the end of a picture.
struct WindowContents {
  const Window& window;
  ViewState& view;
  /// Null while no scan is open.
  Simulation* simulation;
  /// Null while no recording is played.
  const Playback* playback;
  const FilesPanel& files;
  const SpindleState& sound;
  double pictures_per_s;
  std::size_t triangles;
};

/// Works the window in place of a person. The program has none; the tests' driver reads a script
/// (tests/window/driver). All calls come from the window's thread.
class WindowDriver {
 public:
  WindowDriver() = default;
  WindowDriver(const WindowDriver&) = delete;
  WindowDriver& operator=(const WindowDriver&) = delete;
  virtual ~WindowDriver() = default;

  /// Returns whether it begins while the first scan is still being opened.
  virtual bool starts_before_scan() const = 0;
  /// Gives ImGui the input of the next picture, `passed_s` after the last one. `is_settled`: nothing is being
  /// prepared, written or brought to its place.
  virtual void give_input(double passed_s, bool is_settled, Window& window) = 0;
  /// Reads the window after ImGui was drawn and before the picture is shown.
  virtual void read(const WindowContents& contents) = 0;
  /// Returns whether the window is to close without a question.
  virtual bool wants_to_close() const = 0;
  /// Is called once, after the last picture.
  virtual void finish() = 0;
};

}  // namespace osteomill::app
