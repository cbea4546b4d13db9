#include "osteomill/visual/offscreen_context.h"

#include <latch>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <dlfcn.h>
#include <epoxy/egl.h>

namespace osteomill {

namespace {

void require(bool good, const char* what) {
  if (!good) throw std::runtime_error(std::string("no OpenGL without a display: ") + what);
}

// epoxy aborts the process if it cannot load the library.
bool can_be_loaded(const char* library) {
  return dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr;
}

// Mesa renders with its own threads, about one per core, and blocks forever if one cannot be started.
bool can_start_threads() {
  std::latch all_are_there(1);
  std::vector<std::jthread> threads;
  bool started = true;
  try {
    const std::size_t wanted = std::thread::hardware_concurrency() + 4;
    while (threads.size() < wanted) threads.emplace_back([&] { all_are_there.wait(); });
  } catch (const std::system_error&) {
    started = false;
  }
  all_are_there.count_down();
  return started;
}

// EGL returns the same display to all threads, and terminating it ends all their contexts; only the last user
// does so.
std::mutex display_mutex;
int display_users = 0;

EGLDisplay begin_display() {
  const std::scoped_lock lock(display_mutex);
  const EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  require(display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE,
          "EGL cannot be started");
  ++display_users;
  return display;
}

void end_display(EGLDisplay display) {
  const std::scoped_lock lock(display_mutex);
  if (--display_users == 0) eglTerminate(display);
}

}  // namespace

struct OffscreenContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  ~Impl() {
    if (display == EGL_NO_DISPLAY) return;
    if (context != EGL_NO_CONTEXT) {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display, context);
    }
    eglReleaseThread();
    end_display(display);
  }
};

OffscreenContext::OffscreenContext() : impl_(std::make_unique<Impl>()) {
  require(can_be_loaded("libEGL.so.1"), "libEGL.so.1 is missing");
  require(can_be_loaded("libOpenGL.so.0") || can_be_loaded("libGL.so.1"), "libOpenGL.so.0 is missing");
  require(can_start_threads(), "no threads can be started for it (ulimit -u)");
  require(epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"),
          "EGL has no surfaceless platform");
  impl_->display = begin_display();
  require(eglBindAPI(EGL_OPENGL_API) == EGL_TRUE, "EGL has no desktop OpenGL");
  const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                           3,
                           EGL_CONTEXT_MINOR_VERSION,
                           3,
                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                           EGL_NONE};
  impl_->context = eglCreateContext(impl_->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
  require(impl_->context != EGL_NO_CONTEXT, "no OpenGL 3.3 core");
  require(eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, impl_->context) == EGL_TRUE,
          "its context cannot be used");
}

OffscreenContext::~OffscreenContext() = default;

}  // namespace osteomill
