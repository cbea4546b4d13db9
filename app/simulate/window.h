#pragma once

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"

#include "app/simulate/preferences.h"

struct GLFWwindow;

namespace osteomill::app {

/// A window with an OpenGL 3.3 core context, current in the thread that made it, and Dear ImGui in it. One at
/// a time. Throws InputError if none can be opened (no display).
class Window {
 public:
  /// `size` is what it would have on an ordinary screen; it is no larger than the screen. `ui_scale`: how
  /// much larger than usual text is, else as the screen asks for. `place`: where it was last, and takes its
  /// place and size again if a screen still has room for it.
  Window(const std::string& title, const PixelSize& size, const std::optional<double>& ui_scale,
         const WindowPlace& place);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Asks to close the window, as its own button does.
  void ask_to_close();
  /// Returns whether closing was asked for since the last call.
  bool take_close_asked();
  void set_title(const std::string& title);
  /// Returns the size of the framebuffer.
  PixelSize size() const;
  /// Returns where it stands; while it fills the screen or is hidden, where it stood before.
  WindowPlace place();
  void toggle_full_screen();
  void resize(const PixelSize& size);

  /// Returns how much larger than usual text is drawn: what was asked for, as far as the window has room for
  /// it. It holds for this picture, from `begin_frame` on.
  double ui_scale() const { return scale_; }
  void ask_ui_scale(double scale) { asked_scale_ = scale; }
  /// Gives the panels these colours. Not between `begin_frame` and `end_frame`.
  void ask_theme(Theme theme);

  /// The files and folders that were dropped onto the window since the last call.
  std::vector<std::string> take_dropped() { return std::exchange(dropped_, {}); }
  /// Takes a file as if it had been dropped on the window.
  void drop(const std::string& path) { dropped_.push_back(path); }

  /// Keeps the pointer to the window, unseen, so that it moves without an end and points at no panel; or
  /// gives it back where it was.
  void hold_pointer(bool is_held);
  /// Returns whether the keyboard went to another window since the last call.
  bool take_focus_lost() { return std::exchange(focus_lost_, false); }

  /// Takes the events in and begins ImGui's frame.
  void begin_frame();
  /// Draws ImGui over what is in the framebuffer.
  void end_frame();
  /// Returns the picture in the framebuffer.
  Image picture() const;
  void show();

 private:
  struct KeyEvent {
    int key;
    int scancode;
    int action;
    int mods;
  };
  void hand_over_keys();

  void follow_scale();
  void follow_pointer();

  GLFWwindow* window_ = nullptr;
  std::optional<double> asked_scale_;
  double content_scale_ = 0;
  double screens_scale_ = 1;
  double scale_ = 0;
  bool is_pointer_held_ = false;
  bool is_pointer_moved_ = false;
  bool has_focus_ = false;
  bool focus_lost_ = false;
  std::deque<KeyEvent> key_events_;
  std::vector<std::string> dropped_;
  Theme theme_ = Theme::dark;
  WindowPlace windowed_place_;
};

}  // namespace osteomill::app
