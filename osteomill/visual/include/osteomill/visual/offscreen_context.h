#pragma once

#include <memory>

namespace osteomill {

/// OpenGL 3.3 core context without a window or display (EGL, surfaceless). It is current in the thread that
/// created it, which must also destroy it and must not use another context meanwhile; each thread may have
/// one. All drawing needs a current context, this one or a window's. Throws std::runtime_error if the system
/// provides none.
class OffscreenContext {
 public:
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
