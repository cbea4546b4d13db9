#include "osteomill/view/offscreen_context.h"

#include <stdexcept>
#include <string>

#include <epoxy/egl.h>

namespace osteomill {

namespace {

void require(bool good, const char* what) {
  if (!good) throw std::runtime_error(std::string("no OpenGL without a display: ") + what);
}

}  // namespace

struct OffscreenContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  ~Impl() {
    if (display == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    eglTerminate(display);
  }
};

OffscreenContext::OffscreenContext() : impl_(std::make_unique<Impl>()) {
  require(epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"),
          "EGL knows no surfaceless platform");
  impl_->display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  require(impl_->display != EGL_NO_DISPLAY && eglInitialize(impl_->display, nullptr, nullptr) == EGL_TRUE,
          "EGL cannot be started");
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
