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

/// A window with Dear ImGui and an OpenGL 3.3 core context, which is current in the thread that created it.
/// One at a time. Throws InputError if none can be opened (no display).
class Window {
 public:
  /// `size` is the size on an ordinary screen, limited to the screen. `ui_scale` is the text scale; if unset,
  /// it follows the screen. `place` is the last position and size, used again if they fit a screen.
  Window(const std::string& title, const PixelSize& size, const std::optional<double>& ui_scale,
         const WindowPlace& place);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Requests closing, as the window's close button does.
  void request_close();
  /// Returns whether closing was requested since the last call.
  bool take_close_request();
  void set_title(const std::string& title);
  /// Returns the size of the framebuffer.
  PixelSize size() const;
  /// Returns the window's place; while it is full screen or hidden, the place before that.
  WindowPlace place();
  void toggle_full_screen();
  void resize(const PixelSize& size);

  /// Returns the text scale of this frame, fixed by `begin_frame`: the requested one, limited by the size of
  /// the window.
  double ui_scale() const { return scale_; }
  void request_ui_scale(double scale) { asked_scale_ = scale; }
  /// Sets the colours of the panels. Not between `begin_frame` and `end_frame`.
  void request_theme(Theme theme);

  /// Returns the files and folders dropped onto the window since the last call.
  std::vector<std::string> take_dropped() { return std::exchange(dropped_, {}); }
  /// Handles a file as if it had been dropped onto the window.
  void drop(const std::string& path) { dropped_.push_back(path); }

  /// Captures and hides the pointer, so that it moves without limits and does not point at panels; or
  /// releases it at its previous position.
  void hold_pointer(bool is_held);
  /// Returns whether the window lost the keyboard focus since the last call.
  bool take_focus_lost() { return std::exchange(focus_lost_, false); }

  /// Processes events and begins ImGui's frame.
  void begin_frame();
  /// Draws ImGui over the framebuffer.
  void end_frame();
  /// Reads the framebuffer.
  Image picture() const;
  void show();

 private:
  struct KeyEvent {
    int key;
    int scancode;
    int action;
    int mods;
  };
  void forward_keys();

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
