#pragma once

#include <memory>

namespace osteomill {

/// An OpenGL 3.3 core context without a window or a display (EGL, surfaceless). It is current in the thread
/// that made it, which also has to destroy it and may have no other meanwhile; each thread may have one.
/// Whatever draws needs a current context, this one or a window's. Throws std::runtime_error if the system
/// has none to give.
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
