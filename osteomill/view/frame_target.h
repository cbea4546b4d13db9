#pragma once

#include <vector>

#include "osteomill/image/image.h"
#include "osteomill/view/camera.h"
#include "osteomill/view/gl_objects.h"

namespace osteomill {

/// What is drawn into: colours and depths of one size, as textures.
class FrameTarget {
 public:
  explicit FrameTarget(const PixelSize& size);

  const PixelSize& size() const { return size_; }
  void bind() const;
  GLuint framebuffer() const { return framebuffer_.get(); }
  GLuint colours() const { return colours_.get(); }
  GLuint depths() const { return depths_.get(); }
  Image read() const;
  /// 0 to 1, row by row from the bottom.
  std::vector<float> read_depths() const;

 private:
  PixelSize size_;
  gl::Texture colours_;
  gl::Texture depths_;
  gl::Framebuffer framebuffer_;
};

}  // namespace osteomill
