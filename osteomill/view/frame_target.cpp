#include "osteomill/view/frame_target.h"

#include <algorithm>
#include <stdexcept>

#include "osteomill/view/scene_renderer.h"

namespace osteomill {

FrameTarget::FrameTarget(const PixelSize& size)
    : size_(size),
      // In the order of a window's own, so that nothing is turned over on the way there.
      colours_(gl::make_texture(GL_RGBA8, GL_BGRA, GL_UNSIGNED_BYTE, size.width, size.height, GL_NEAREST)),
      depths_(gl::make_texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, size.width,
                               size.height, GL_NEAREST)),
      framebuffer_(gl::make_framebuffer()) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colours_.get(), 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depths_.get(), 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("OpenGL refuses a framebuffer");
  }
}

void FrameTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glViewport(0, 0, size_.width, size_.height);
}

Image FrameTarget::read() const {
  return read_framebuffer(framebuffer_.get(), size_);
}

std::vector<float> FrameTarget::read_depths() const {
  std::vector<float> depths(static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.get());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size_.width, size_.height, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  return depths;
}

Image read_framebuffer(unsigned framebuffer, const PixelSize& size) {
  Image image{size.width, size.height, {}};
  const std::size_t row = 3 * static_cast<std::size_t>(size.width);
  std::vector<unsigned char> upside_down(row * static_cast<std::size_t>(size.height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.width, size.height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
  image.rgb.resize(upside_down.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(size.height); ++y) {
    std::copy_n(upside_down.end() - static_cast<std::ptrdiff_t>((y + 1) * row), row,
                image.rgb.begin() + static_cast<std::ptrdiff_t>(y * row));
  }
  return image;
}

}  // namespace osteomill
