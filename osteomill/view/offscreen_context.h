#pragma once

#include <memory>

namespace osteomill {

/// An OpenGL 3.3 core context without a window or a display (EGL, surfaceless), current in the thread that
/// made it, which is to end it too and has no other meanwhile; each thread may have one. Everything else that
/// draws needs a current context and does not care which. Throws std::runtime_error where the system has none
/// to give.
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
