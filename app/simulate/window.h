#pragma once

#include <string>

#include "osteomill/surface/image.h"
#include "osteomill/view/camera.h"

struct GLFWwindow;

namespace osteomill::app {

/// A window with an OpenGL 3.3 core context, current in the thread that made it, and Dear ImGui in it. One at
/// a time. Throws InputError where none can be opened (no display).
class Window {
 public:
  Window(const std::string& title, const PixelSize& size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// As the window's own button does.
  void ask_to_close();
  /// Whether closing was asked for since the last call.
  bool take_close_asked();
  /// Of the framebuffer.
  PixelSize size() const;
  void toggle_full_screen();

  /// Takes the events in and begins ImGui's frame.
  void begin_frame();
  /// Draws ImGui over what is in the framebuffer.
  void end_frame();
  /// What is in the framebuffer.
  Image picture() const;
  void show();

 private:
  GLFWwindow* window_ = nullptr;
  int windowed_place_[4] = {0, 0, 0, 0};
};

}  // namespace osteomill::app
