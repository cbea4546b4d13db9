#include "app/simulate/window.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <filesystem>
#include <utility>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include "osteomill/base/input_error.h"
#include "osteomill/visual/annotations.h"
#include "osteomill/visual/scene_renderer.h"

#include "app/simulate/screen_scale.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

bool is_modifier(int key) {
  return key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER;
}

void set_fonts(double scale) {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  const float size_px = static_cast<float>(scale) * kFontSize_px;
  if (std::filesystem::exists(kFontFile)) {
    fonts.AddFontFromFileTTF(kFontFile, size_px);
  } else {
    ImFontConfig config;
    config.SizePixels = size_px;
    fonts.AddFontDefault(&config);
  }
}

// Returns the screen that contains the window's centre, or the first one.
GLFWmonitor* monitor_of(GLFWwindow* window) {
  int left = 0, top = 0, width = 0, height = 0, count = 0;
  glfwGetWindowPos(window, &left, &top);
  glfwGetWindowSize(window, &width, &height);
  GLFWmonitor** const monitors = glfwGetMonitors(&count);
  for (int n = 0; n < count; ++n) {
    int x = 0, y = 0;
    glfwGetMonitorPos(monitors[n], &x, &y);
    const GLFWvidmode* const mode = glfwGetVideoMode(monitors[n]);
    const int right = left + width / 2 - x;
    const int down = top + height / 2 - y;
    if (mode != nullptr && right >= 0 && down >= 0 && right < mode->width && down < mode->height)
      return monitors[n];
  }
  return glfwGetPrimaryMonitor();
}

double screens_scale(GLFWmonitor* monitor, double content_scale) {
  Screen screen{{0, 0}, 0, content_scale};
  const GLFWvidmode* const mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
  if (mode != nullptr) {
    int width_mm = 0, height_mm = 0;
    glfwGetMonitorPhysicalSize(monitor, &width_mm, &height_mm);
    screen.size = {mode->width, mode->height};
    screen.height_mm = height_mm;
  }
  return scale_for(screen);
}

// Returns whether this stored place is usable: within a connected screen and not too small.
bool is_on_a_screen(const WindowPlace& place) {
  constexpr int kLeast_px = 200;
  int count = 0;
  GLFWmonitor** const monitors = glfwGetMonitors(&count);
  return std::min(place.width, place.height) >= kLeast_px &&
         std::any_of(monitors, monitors + count, [&](GLFWmonitor* one) {
           int left = 0, top = 0, width = 0, height = 0;
           glfwGetMonitorWorkarea(one, &left, &top, &width, &height);
           return place.left >= left && place.top >= top && place.left + place.width <= left + width &&
                  place.top + place.height <= top + height;
         });
}

// Returns the size scaled like the text and limited to the screen without its bars.
PixelSize fitting_size(const PixelSize& size, const std::optional<double>& ui_scale) {
  GLFWmonitor* const monitor = glfwGetPrimaryMonitor();
  if (monitor == nullptr) return size;
  float content_scale = 1;
  glfwGetMonitorContentScale(monitor, &content_scale, nullptr);
  const double scale = ui_scale.value_or(screens_scale(monitor, static_cast<double>(content_scale)));
  int left = 0, top = 0, width = 0, height = 0;
  glfwGetMonitorWorkarea(monitor, &left, &top, &width, &height);
  const auto fitting = [scale](int length, int room) {
    const int wanted = static_cast<int>(std::lround(length * std::max(scale, 1.0)));
    return room > 0 ? std::min(wanted, room) : wanted;
  };
  return {fitting(size.width, width), fitting(size.height, height)};
}

}  // namespace

Window::Window(const std::string& title, const PixelSize& size, const std::optional<double>& ui_scale,
               const WindowPlace& place)
    : asked_scale_(ui_scale) {
  if (glfwInit() == GLFW_FALSE) throw InputError("simulate", "cannot open a window: " + last_glfw_error());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  // The renderer has its own depth buffer; the window shows only the result.
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  const bool is_placed = is_on_a_screen(place);
  const PixelSize fitting = is_placed ? PixelSize{place.width, place.height} : fitting_size(size, ui_scale);
  window_ = glfwCreateWindow(fitting.width, fitting.height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string reason = last_glfw_error();
    glfwTerminate();
    throw InputError("simulate", "cannot open a window: " + reason);
  }
  if (is_placed) glfwSetWindowPos(window_, place.left, place.top);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, this);
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
    auto* const self = static_cast<Window*>(glfwGetWindowUserPointer(window));
    for (int n = 0; n < count; ++n) self->drop(paths[n]);
  });
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int mods) {
    if (action == GLFW_REPEAT) return;
    static_cast<Window*>(glfwGetWindowUserPointer(window))
        ->key_events_.push_back({key, scancode, action, mods});
  });
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::request_close() {
  glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

bool Window::take_close_request() {
  const bool asked = glfwWindowShouldClose(window_) == GLFW_TRUE;
  glfwSetWindowShouldClose(window_, GLFW_FALSE);
  return asked;
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

PixelSize Window::size() const {
  PixelSize size;
  glfwGetFramebufferSize(window_, &size.width, &size.height);
  return size;
}

WindowPlace Window::place() {
  if (glfwGetWindowMonitor(window_) == nullptr &&
      glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_FALSE) {
    glfwGetWindowPos(window_, &windowed_place_.left, &windowed_place_.top);
    glfwGetWindowSize(window_, &windowed_place_.width, &windowed_place_.height);
  }
  return windowed_place_;
}

void Window::toggle_full_screen() {
  const WindowPlace last = place();
  if (glfwGetWindowMonitor(window_) != nullptr) {
    glfwSetWindowMonitor(window_, nullptr, last.left, last.top, last.width, last.height, 0);
    return;
  }
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  if (monitor == nullptr) return;
  const GLFWvidmode* mode = glfwGetVideoMode(monitor);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

// ImGui samples the keys once per frame. An event waits for the next frame, with all later ones, if its key
// has already changed in this frame, so that no key press is lost; or if it changes a modifier after another
// key, so that a chord counts with the modifiers it was pressed with.
void Window::forward_keys() {
  std::vector<int> changed;
  const auto waits = [&](const KeyEvent& event) {
    return std::ranges::find(changed, event.key) != changed.end() ||
           (is_modifier(event.key) && !std::ranges::all_of(changed, is_modifier));
  };
  for (; !key_events_.empty() && !waits(key_events_.front()); key_events_.pop_front()) {
    const KeyEvent& event = key_events_.front();
    changed.push_back(event.key);
    ImGui_ImplGlfw_KeyCallback(window_, event.key, event.scancode, event.action, event.mods);
  }
}

void Window::request_theme(Theme theme) {
  if (theme != std::exchange(theme_, theme)) set_theme(theme, static_cast<float>(scale_));
}

void Window::resize(const PixelSize& size) {
  glfwSetWindowSize(window_, size.width, size.height);
}

// Applies changes of the screen, the window's size, or the requested scale.
void Window::follow_scale() {
  float content_scale = 1;
  glfwGetWindowContentScale(window_, &content_scale, nullptr);
  if (static_cast<double>(content_scale) != content_scale_) {
    content_scale_ = static_cast<double>(content_scale);
    screens_scale_ = screens_scale(monitor_of(window_), content_scale_);
  }
  const PixelSize now = size();
  if (now.width < 1 || now.height < 1) return;
  const double scale = fitting_scale(asked_scale_.value_or(screens_scale_), now);
  if (scale == scale_) return;
  scale_ = scale;
  set_theme(theme_, static_cast<float>(scale));
  set_fonts(scale);
  ui::set_scale(scale);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Window::hold_pointer(bool is_held) {
  if (is_pointer_held_ == is_held) return;
  is_pointer_held_ = is_held;
  is_pointer_moved_ = true;
  glfwSetInputMode(window_, GLFW_CURSOR, is_held ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
}

// Moves a captured pointer far away from all panels, which would otherwise receive its input.
void Window::follow_pointer() {
  constexpr float kFar_px = 1e5f;
  ImGuiIO& io = ImGui::GetIO();
  if (is_pointer_held_) io.MousePos = {io.MousePos.x + kFar_px, io.MousePos.y + kFar_px};
  // Moving the pointer there and back is not input.
  if (std::exchange(is_pointer_moved_, false)) io.MousePosPrev = {-FLT_MAX, -FLT_MAX};
  const bool has_focus = glfwGetWindowAttrib(window_, GLFW_FOCUSED) == GLFW_TRUE;
  focus_lost_ = focus_lost_ || (has_focus_ && !has_focus);
  has_focus_ = has_focus;
}

void Window::begin_frame() {
  glfwPollEvents();
  forward_keys();
  follow_scale();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  follow_pointer();
}

void Window::end_frame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

Image Window::picture() const {
  return read_framebuffer(0, size());
}

void Window::show() {
  glfwSwapBuffers(window_);
}

}  // namespace osteomill::app
